"""What a rig recorded: depth images or partial clouds, each with the pose that the rig believes in.

A camera looks along its z axis, x to the right, y down. Poses lead from the frame of the view to
that of the rig.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from prunus.model.arrays import Bools, Bytes, Floats, frozen
from prunus.model.cloud import RigidMotion


@dataclass(frozen=True, kw_only=True)
class Camera:
    """Focal lengths and principal point, pixels; the middle of the first pixel is at 0.5, 0.5."""

    fx: float
    fy: float
    cx: float
    cy: float


@dataclass(frozen=True, eq=False, kw_only=True)
class DepthView:
    """A depth image (H, W), metres along z, 0 = nothing; optional rgb (H, W, 3) and mask (H, W).

    Only what the mask has true belongs to the scene.
    """

    name: str
    depth: Floats
    camera: Camera
    nominal: RigidMotion
    rgb: Bytes | None = None
    mask: Bools | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "depth", frozen(self.depth, np.float64, (None, None)))
        H, W = self.depth.shape
        if self.rgb is not None:
            object.__setattr__(self, "rgb", frozen(self.rgb, np.uint8, (H, W, 3)))
        if self.mask is not None:
            object.__setattr__(self, "mask", frozen(self.mask, np.bool_, (H, W)))


@dataclass(frozen=True, eq=False, kw_only=True)
class CloudView:
    """A partial cloud: points xyz (Q, 3), metres, in the frame of the view; optional rgb (Q, 3)."""

    name: str
    xyz: Floats
    nominal: RigidMotion
    rgb: Bytes | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "xyz", frozen(self.xyz, np.float64, (None, 3)))
        if self.rgb is not None:
            object.__setattr__(self, "rgb", frozen(self.rgb, np.uint8, (len(self.xyz), 3)))


RigView = DepthView | CloudView
"""One view of a rig."""
