"""A point cloud in the house frame, and the way back to the frame of its file."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from prunus.errors import PrunusError
from prunus.model.arrays import GRID, Bools, Bytes, Floats, Ints, cubes, frozen, snapped

FRAMES: dict[str, Floats] = {
    "z-up": np.eye(3),
    "z-up-x-row": np.eye(3),
    "optical": np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]),
    "camera-link": np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
    "y-up": np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]),
    "z-down": np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]]),
    "x-up": np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]),
    "x-down": np.array([[0.0, 1.0, 0.0], [0.0, 0.0, -1.0], [-1.0, 0.0, 0.0]]),
}
"""Named input frames -> rotation (3, 3) into the house frame: X along the row, Y depth, Z up.

`optical` is a camera's frame: x right, y down, z forward. `camera-link` is ROS's body frame: x
forward, y left, z up. `y-up` is that of graphics: x right, y up, z toward the viewer. The most
usual frame of each upward axis comes first. docs/frames.md has them all.
"""

ROW_TOLD = frozenset({"z-up-x-row", "optical", "camera-link"})
"""Frames that say where the row runs: along X, or across the line of sight. In the others only the
upward axis is known."""


@dataclass(frozen=True, eq=False)
class RigidMotion:
    """A rotation (3, 3), then a translation (3,), metres."""

    rotation: Floats
    translation: Floats

    def __post_init__(self) -> None:
        turn = frozen(self.rotation, np.float64, (3, 3), "rotation")
        shift = frozen(self.translation, np.float64, (3,), "translation")
        if not np.isfinite(shift).all():
            raise PrunusError(f"translation: {shift}; expected finite numbers")
        object.__setattr__(self, "rotation", turn)
        object.__setattr__(self, "translation", shift)

    def apply(self, xyz: ArrayLike) -> Floats:
        """The points (..., 3) moved."""
        return np.asarray(xyz, dtype=np.float64) @ self.rotation.T + self.translation

    def inverse(self) -> RigidMotion:
        """The motion back."""
        return RigidMotion(self.rotation.T, -self.rotation.T @ self.translation)


CUBE_M, DENSEST, CHANCE = 0.02, 5.0, 12
"""Side of the cubes in which density is looked at; the densest that stays as it is, in medians, and
in points, since the density of a sparse cloud varies by chance."""


@dataclass(frozen=True, eq=False)
class PointCloud:
    """Points xyz (P, 3) in the house frame, metres, around their own middle; optional rgb (P, 3).

    `to_input` is the rigid motion back to the frame in which the cloud came.
    Make one with `PointCloud.from_xyz`.
    """

    xyz: Floats
    to_input: RigidMotion
    rgb: Bytes | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.to_input, RigidMotion):
            raise PrunusError(f"to_input: {type(self.to_input).__name__}; expected a RigidMotion")
        object.__setattr__(self, "xyz", _points(self.xyz))
        if self.rgb is not None:
            rgb = frozen(self.rgb, np.uint8, (len(self.xyz), 3), "rgb")
            object.__setattr__(self, "rgb", rgb)

    def __len__(self) -> int:
        return len(self.xyz)

    @classmethod
    def from_xyz(
        cls,
        xyz: ArrayLike,
        frame: str = "z-up",
        rgb: ArrayLike | None = None,
        turn: ArrayLike | None = None,
        middle: ArrayLike | None = None,
    ) -> PointCloud:
        """A cloud from points (P, 3), metres, in a named frame (see `FRAMES`).

        Axes are turned as the name says and no further: nothing is levelled, and no row is looked
        for, as `prunus.read_cloud` does. `turn` (3, 3) is a further rotation, from there to the
        house frame; `prunus.frames.stance.find_stance` finds one. `middle` (3,), where in that the
        origin of the house frame is: the middle of the points, where it is not told.

        The points are turned into the house frame and shifted to a local origin in double
        precision, so that large coordinates (UTM) keep their millimetres.
        Raises PrunusError on an unknown frame, a wrong shape, no points, NaN or infinity, colours
        that are not whole numbers from 0 to 255, or a turn that is no rotation.
        """
        points = _points(xyz)
        if len(points) == 0:
            raise PrunusError("the cloud holds no points; expected at least one")
        if not isinstance(frame, str) or frame not in FRAMES:
            raise PrunusError(f"unknown frame {frame!r}; expected one of {', '.join(FRAMES)}")
        rotation = FRAMES[frame] if turn is None else _rotation(turn) @ FRAMES[frame]
        turned = points @ rotation.T
        # On the grid, so that a part of the cloud by itself falls on the same places; halves go up,
        # wherever the origin of the input is.
        on_grid = GRID * np.floor(middle_of(turned) / GRID + 0.5)
        middle = on_grid if middle is None else np.asarray(middle)
        back = RigidMotion(rotation, -middle).inverse()
        colours = None if rgb is None else frozen(rgb, np.uint8, points.shape, "rgb")
        return cls(snapped(turned - middle), back, colours)

    def words_for(self, place: Floats) -> str:
        """A place (3,), house frame, as a person reads it: (x, y, z) in the frame of the input."""
        return "(" + ", ".join(f"{value:.2f}" for value in self.to_input.apply(place)) + ")"

    def take(self, rows: Ints | Bools) -> PointCloud:
        """The cloud of these rows only, in the same frame."""
        rgb = None if self.rgb is None else self.rgb[rows]
        return PointCloud(self.xyz[rows], self.to_input, rgb)

    def sample(self, count: int | None, rng: np.random.Generator) -> PointCloud:
        """At most `count` points drawn at random without replacement (None keeps all)."""
        if count is None or count >= len(self):
            return self
        return self.take(np.sort(rng.choice(len(self), count, replace=False, shuffle=False)))

    def sample_evenly(self, count: int | None, rng: np.random.Generator) -> PointCloud:
        """At most `count` points, drawn evenly over space (None keeps all).

        No cube of 2 cm keeps more than five times the median of all cubes; which of its points
        stay is random. So a trunk that a scanner passed ten times does not starve the twigs.
        """
        if count is None or count >= len(self):
            return self
        # Cubes about the middle: a cloud turned half round falls into the same ones.
        cell = cubes(np.rint((self.xyz - middle_of(self.xyz)) / CUBE_M), 1.0)
        _, cube, holds = np.unique(cell, return_inverse=True, return_counts=True)
        most = max(CHANCE, int(DENSEST * np.median(holds)))
        # Its place (P,) among the points of its cube, these in random order.
        order = rng.permutation(len(self))
        order = order[np.argsort(cube[order], kind="stable")]
        place = np.arange(len(self)) - np.repeat(np.cumsum(holds) - holds, holds)
        return self.take(np.sort(order[place < most])).sample(count, rng)


def middle_of(xyz: Floats) -> Floats:
    """The middle (3,) of the box around points (P, 3)."""
    return np.asarray((xyz.min(axis=0) + xyz.max(axis=0)) / 2)


def _points(xyz: ArrayLike) -> Floats:
    """Points (P, 3) that can be reckoned with."""
    points = frozen(xyz, np.float64, (None, 3), "the cloud")
    bad = ~np.isfinite(points).all(axis=1)
    if bad.any():
        raise PrunusError(
            f"{bad.sum()} of {len(points)} points hold NaN or infinity "
            f"(the first is point {int(bad.argmax())}); expected finite coordinates"
        )
    far = np.abs(points).max(initial=0.0)
    if far > FARTHEST_M:
        raise PrunusError(f"the cloud has a coordinate of {far:.3g} m; expected metres on Earth")
    return points


FARTHEST_M = 1e9
"""No coordinate is larger: that of a projection on Earth is 1e7, and 1e9 still has micrometres."""


def _rotation(turn: ArrayLike) -> Floats:
    matrix = frozen(turn, np.float64, (3, 3), "turn")
    if not np.allclose(matrix @ matrix.T, np.eye(3), atol=1e-6) or np.linalg.det(matrix) < 0:
        raise PrunusError("turn: no rotation; expected an orthonormal matrix (3, 3)")
    return matrix
