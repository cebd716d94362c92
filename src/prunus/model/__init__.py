"""The values that walk through the hall. Frozen: a change is a new value.

The letters, said once: P points, N superpoints, E candidate edges, M skeleton nodes, T tips,
K candidates (the population).
"""

from prunus.model.arrays import Bools, Floats, Ints
from prunus.model.cloud import FRAMES, ROW_TOLD, PointCloud, RigidMotion
from prunus.model.graph import CandidateGraph, ScoredGraph, SeededGraph, Superpoints
from prunus.model.kind import Kind
from prunus.model.rig import Camera, CloudView, DepthView, RigView
from prunus.model.role import Role
from prunus.model.skeleton import Label, Lines, Skeleton, parents_first
from prunus.model.told import Told

__all__ = [
    "FRAMES",
    "ROW_TOLD",
    "Bools",
    "Camera",
    "CandidateGraph",
    "CloudView",
    "DepthView",
    "Floats",
    "Ints",
    "Kind",
    "Label",
    "Lines",
    "PointCloud",
    "RigView",
    "RigidMotion",
    "Role",
    "ScoredGraph",
    "SeededGraph",
    "Skeleton",
    "Superpoints",
    "Told",
    "parents_first",
]
