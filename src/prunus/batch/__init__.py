"""Many trees: read, skeletonized and written one after another, or side by side."""
