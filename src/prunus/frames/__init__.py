"""From a file's frame to the row's frame and back: which way is up, and is that a tree at all."""
