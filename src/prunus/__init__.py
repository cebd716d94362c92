"""From a 3D point cloud of a dormant fruit tree to a labelled skeleton."""

__version__ = "0.1.0"
