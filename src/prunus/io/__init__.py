"""Files in and out. Everything is validated at this door."""

from prunus.io.clouds.cloud_file import FileCloud, read_cloud
from prunus.io.skeletons.skeleton_file import read_skeleton, write_skeleton

__all__ = ["FileCloud", "read_cloud", "read_skeleton", "write_skeleton"]
