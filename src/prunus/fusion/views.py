"""From a view to points: mask, drop flying pixels, back-project."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from prunus.fusion.pixels import company
from prunus.model import Camera, CloudView, DepthView, Floats, RigidMotion, RigView
from prunus.model.arrays import Bytes

SLACK = 0.011
"""Neighbours at one depth differ by so much in 1 / depth, at most, 1 / m: 2.5 cm at 1.5 m."""
COMPANY = 2
"""A pixel with fewer of its eight neighbours at its depth flies."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Seen:
    """The points xyz (Q, 3) of a view in its own frame, rgb (Q, 3) or None, and its nominal pose.

    `pixel`: width of a pixel at 1 m, metres; 0 = the points were not seen from the origin.
    `flying`: how many pixels were dropped.
    """

    name: str
    xyz: Floats
    rgb: Bytes | None
    nominal: RigidMotion
    pixel: float
    flying: int


def seen(view: RigView) -> Seen:
    """The points of a view; those of a depth image without its flying pixels."""
    if isinstance(view, CloudView):
        return Seen(
            name=view.name, xyz=view.xyz, rgb=view.rgb, nominal=view.nominal, pixel=0.0, flying=0
        )
    return _seen_by_camera(view)


def _seen_by_camera(view: DepthView) -> Seen:
    depth = view.depth if view.mask is None else np.where(view.mask, view.depth, 0.0)
    kept = company(depth, SLACK) >= COMPANY
    xyz = back_projected(np.where(kept, depth, 0.0), view.camera)
    rgb = None if view.rgb is None else view.rgb[kept]
    flying = int((depth > 0).sum() - kept.sum())
    return Seen(
        name=view.name,
        xyz=xyz,
        rgb=rgb,
        nominal=view.nominal,
        pixel=1 / view.camera.fx,
        flying=flying,
    )


def back_projected(depth: Floats, camera: Camera) -> Floats:
    """The points (Q, 3) of a depth image (H, W) in the camera's frame, row by row."""
    rows, columns = np.nonzero(depth > 0)
    z = depth[rows, columns]
    x = (columns + 0.5 - camera.cx) / camera.fx * z
    y = (rows + 0.5 - camera.cy) / camera.fy * z
    return np.column_stack([x, y, z])
