"""Centre lines and radii of a skeleton, fitted to the points of its tree."""
