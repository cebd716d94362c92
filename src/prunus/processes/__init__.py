"""Work in other processes, and how it ends."""
