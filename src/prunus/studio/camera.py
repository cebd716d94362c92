"""Where the eye stands: the named views, and the image in which a person draws."""

from __future__ import annotations

from dataclasses import dataclass
from math import radians, tan

import numpy as np

from prunus.model import Floats

FOV = radians(25)
"""Vertical field of view: narrow, so that what is behind looks hardly smaller."""
ROOM = 1.12
"""A view leaves so much room around what it shows."""
VIEWS = {
    "front": ((0.0, -1.0, 0.0), 0, 2, 1),
    "side": ((1.0, 0.0, 0.0), 1, 2, 0),
    "top": ((0.0, -1e-3, 1.0), 0, 1, 2),
}
"""Where the eye is, seen from the tree, and the axes across, up and in depth."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Eye:
    """A camera: position (3,), rotation (3, 3) with columns right, down, forward; house frame.

    `fov` is the vertical field of view, radians; width and height those of the image, pixels.
    """

    position: Floats
    rotation: Floats
    fov: float
    width: int
    height: int

    @property
    def pixel(self) -> float:
        """The tangent of the angle of one pixel, in the middle of the image."""
        return 2 * tan(self.fov / 2) / max(self.height, 1)

    @property
    def projection(self) -> Floats:
        """(4, 4) from the house frame to u, v, depth: 0 to 1 from left and top, after division."""
        focal = 1 / (2 * tan(self.fov / 2))
        aspect = self.width / max(self.height, 1)
        lens = np.array([[focal / aspect, 0, 0.5, 0], [0, focal, 0.5, 0], [0, 0, 1, 0],
                         [0, 0, 1, 0]])  # fmt: skip
        pose = np.eye(4)
        pose[:3, :3] = self.rotation.T
        pose[:3, 3] = -self.rotation.T @ self.position
        return np.asarray(lens @ pose)

    def image(self, points: Floats) -> Floats:
        """Points (Q, 3) as u, v (Q, 2): 0 to 1 from left and top."""
        seen = np.column_stack([points, np.ones(len(points))]) @ self.projection.T
        return np.asarray(seen[:, :2] / seen[:, 3:])

    def sheet(self, image: Floats, depth: float) -> Floats:
        """Where places u, v (Q, 2) of the image lie (Q, 3) on a sheet so far before the eye."""
        high = 2 * tan(self.fov / 2) * depth
        wide = high * self.width / max(self.height, 1)
        flat = (image - 0.5) * [wide, high]
        local = np.column_stack([flat, np.full(len(image), depth)])
        return np.asarray(self.position + local @ self.rotation.T)

    def __eq__(self, other: object) -> bool:
        """Whether it is the same camera, to less than a pixel."""
        return (
            isinstance(other, Eye)
            and (self.width, self.height) == (other.width, other.height)
            and np.allclose(self.projection, other.projection, atol=1e-4)
        )

    __hash__ = None  # type: ignore[assignment]


def standing(view: str, low: Floats, high: Floats, aspect: float) -> tuple[Floats, Floats]:
    """Position and aim (3,) of a named view that shows all of a box; aspect: width over height."""
    way, across, up, deep = VIEWS[view]
    extent = np.maximum(high - low, 0.05)
    half = max(extent[up], extent[across] / aspect) / 2 * ROOM
    distance = half / tan(FOV / 2) + extent[deep] / 2
    middle = (low + high) / 2
    return middle + distance * np.array(way), middle
