"""What a click in the scene means: the node, edge or point nearest to its ray."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from prunus.model import Floats

NEAR = 1e-3
"""What is nearer to the eye, metres along the ray, or behind it, cannot be picked."""


@dataclass(frozen=True, eq=False)
class Ray:
    """The ray of a click: origin (3,), unit direction (3,), and the tangent of a pixel's angle."""

    origin: Floats
    direction: Floats
    pixel: float

    def seen(self, points: Floats) -> tuple[Floats, Floats]:
        """Points (..., 3) in the image of the ray: (..., 2) in pixels from it, and their depth."""
        across, upward = _beside(self.direction)
        offset = points - self.origin
        depth = offset @ self.direction
        flat = np.stack([offset @ across, offset @ upward], axis=-1)
        return flat / (np.maximum(depth, NEAR) * self.pixel)[..., None], depth


def nearest_point(ray: Ray, points: Floats, pixels: float) -> int | None:
    """The point (Q, 3) that is seen nearest to the ray, within so many pixels; None for none."""
    flat, depth = ray.seen(points)
    far = np.where(depth > NEAR, np.linalg.norm(flat, axis=-1), np.inf)
    return _least(far, pixels)


def first_point(ray: Ray, points: Floats, pixels: float) -> int | None:
    """The point (Q, 3) nearest to the eye of those within so many pixels of the ray."""
    flat, depth = ray.seen(points)
    hit = (depth > NEAR) & (np.linalg.norm(flat, axis=-1) <= pixels)
    return _least(np.where(hit, depth, np.inf), np.inf)


def nearest_edge(ray: Ray, ends: Floats, pixels: float) -> int | None:
    """The edge (E, 2, 3) that is seen nearest to the ray, within so many pixels; None for none."""
    flat, depth = ray.seen(_in_front(ray, ends))
    start, along = flat[:, 0], flat[:, 1] - flat[:, 0]
    length = (along**2).sum(axis=-1)
    share = -(start * along).sum(axis=-1) / np.maximum(length, 1e-12)
    foot = start + np.clip(share, 0.0, 1.0)[:, None] * along
    far = np.where((depth > NEAR).any(axis=-1), np.linalg.norm(foot, axis=-1), np.inf)
    return _least(far, pixels)


def _in_front(ray: Ray, ends: Floats) -> Floats:
    """The edges with an end behind the eye cut off where they pass it."""
    depth = (ends - ray.origin) @ ray.direction
    cut = ends.copy()
    for end, other in ((0, 1), (1, 0)):
        behind = (depth[:, end] <= NEAR) & (depth[:, other] > NEAR)
        step = depth[behind, other] - depth[behind, end]
        share = ((depth[behind, other] - 2 * NEAR) / step)[:, None]
        cut[behind, end] = ends[behind, other] + share * (ends[behind, end] - ends[behind, other])
    return cut


def _beside(direction: Floats) -> tuple[Floats, Floats]:
    """Two unit vectors across a direction."""
    helper = np.eye(3)[int(np.abs(direction).argmin())]
    across = np.cross(direction, helper)
    across /= np.linalg.norm(across)
    return across, np.cross(across, direction)


def _least(values: Floats, limit: float) -> int | None:
    if len(values) == 0:
        return None
    best = int(values.argmin())
    return best if values[best] <= limit and np.isfinite(values[best]) else None
