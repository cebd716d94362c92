"""What the scan is, before it is a tree: its frame (and, to come, its views and its neighbours)."""
