"""A point cloud in the house frame, and the way back to the frame of its file."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from prunus.errors import PrunusError
from prunus.model.arrays import Bools, Bytes, Floats, Ints, cells, frozen, snapped

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
        object.__setattr__(self, "rotation", frozen(self.rotation, np.float64, (3, 3)))
        object.__setattr__(self, "translation", frozen(self.translation, np.float64, (3,)))

    def apply(self, xyz: ArrayLike) -> Floats:
        """The points (..., 3) moved."""
        return np.asarray(xyz, dtype=np.float64) @ self.rotation.T + self.translation

    def inverse(self) -> RigidMotion:
        """The motion back."""
        return RigidMotion(self.rotation.T, -self.rotation.T @ self.translation)


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
        object.__setattr__(self, "xyz", frozen(self.xyz, np.float64, (None, 3)))
        if self.rgb is not None:
            object.__setattr__(self, "rgb", frozen(self.rgb, np.uint8, (len(self.xyz), 3)))

    def __len__(self) -> int:
        return len(self.xyz)

    @classmethod
    def from_xyz(
        cls,
        xyz: ArrayLike,
        frame: str = "z-up",
        rgb: Bytes | None = None,
        turn: Floats | None = None,
    ) -> PointCloud:
        """A cloud from points (P, 3), metres, in a named frame (see `FRAMES`).

        Axes are turned as the name says and no further: nothing is levelled, and no row is looked
        for, as `prunus.read_cloud` does. `turn` (3, 3) is a further rotation, from there to the
        house frame; `prunus.sensing.stance.find_stance` finds one.

        The points are turned into the house frame and shifted to a local origin in double
        precision, so that large coordinates (UTM) keep their millimetres.
        Raises PrunusError on an unknown frame, a wrong shape, no points, NaN or infinity.
        """
        points = _checked(xyz)
        if frame not in FRAMES:
            raise PrunusError(f"unknown frame {frame!r}; expected one of {', '.join(FRAMES)}")
        rotation = FRAMES[frame] if turn is None else turn @ FRAMES[frame]
        turned = points @ rotation.T
        middle = (turned.min(axis=0) + turned.max(axis=0)) / 2
        back = RigidMotion(rotation, -middle).inverse()
        return cls(snapped(turned - middle), back, rgb)

    def take(self, rows: Ints | Bools) -> PointCloud:
        """The cloud of these rows only, in the same frame."""
        rgb = None if self.rgb is None else self.rgb[rows]
        return PointCloud(self.xyz[rows], self.to_input, rgb)

    def sample(
        self, count: int | None, rng: np.random.Generator, evenly: bool = False
    ) -> PointCloud:
        """At most `count` points drawn at random without replacement (None keeps all).

        `evenly`: over space, so that what was scanned densely does not starve the rest. Where
        points lie denser than in most places, they are thinned to that first.
        """
        if count is None or count >= len(self):
            return self
        rows = _thinned(self.xyz, count, rng) if evenly else np.arange(len(self))
        drawn = rng.choice(len(rows), count, replace=False, shuffle=False)
        return self.take(np.sort(rows[drawn]))


EVEN_M = 0.02
"""Density is told by cubes of that side."""


def _thinned(xyz: Floats, count: int, rng: np.random.Generator) -> Ints:
    """At least `count` rows of points (P, 3): of each cube at most as many as the median holds.

    More where so few do not make up `count`. A sparse cube keeps what it has, so that strays do not
    come to weigh more than they did.
    """
    order = rng.permutation(len(xyz))
    # One number for the cube and for the place in the order: sorting such is the fastest way.
    cube, place = np.divmod(
        np.sort(cells(xyz, EVEN_M, len(xyz))[order] + np.arange(len(xyz))), len(xyz)
    )
    starts = np.flatnonzero(np.diff(cube, prepend=-1))
    held = np.diff(starts, append=len(xyz))
    rank = np.arange(len(xyz)) - np.repeat(starts, held)
    most = max(float(np.median(held)), _level(held, count))
    return np.sort(order[place[rank < most]])


def _level(held: Ints, count: int) -> int:
    """The least number a cube by which cubes that hold so many (N,) give `count` in all."""
    ascending = np.sort(held)
    filled = np.concatenate([[0], np.cumsum(ascending)[:-1]])
    needed = (count - filled) / np.arange(len(held), 0, -1)
    return int(np.ceil(needed[int(np.argmax(needed <= ascending))]))


def _checked(xyz: ArrayLike) -> Floats:
    try:
        points = np.asarray(xyz, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise PrunusError(f"the cloud is not an array of numbers: {error}") from error
    if points.ndim != 2 or points.shape[1] != 3:
        raise PrunusError(f"the cloud has shape {points.shape}; expected (P, 3)")
    if len(points) == 0:
        raise PrunusError("the cloud holds no points; expected at least one")
    bad = ~np.isfinite(points).all(axis=1)
    if bad.any():
        raise PrunusError(
            f"{bad.sum()} of {len(points)} points hold NaN or infinity "
            f"(the first is point {int(bad.argmax())}); expected finite coordinates"
        )
    return points
