"""Several depth views of one tree, registered on each other, to one cloud."""
