"""Trellis wires: thin, level and straight for longer than any branch, which no voxel sees alone.

Lines are guessed from pairs of voxels (RANSAC), the best is fitted and what runs along it is taken
away, until no line is long enough.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from prunus.field.votes import PointField
from prunus.model import Bools, Floats, Role

LEVEL_COS = 0.9
"""A wire is looked for in what runs level by so much (cosine),"""
HEAVY = 0.5
"""is less likely stem or framework,"""
STEEPEST = 0.09
"""and on lines that rise no more than so many metres a metre."""
APART_M = 0.5
"""A line is guessed from two voxels at least so far apart, so often, and judged
by so many at most."""
GUESSES, ENOUGH = 600, 3000
STRAIGHT_M = 0.015
"""A wire is straight but for so much."""
BLURRED_M, ALONG_COS, THIN_ALONG_COS = 0.025, 0.75, 0.3
"""What is seen of it lies so near to it, and runs along it by so much, or, where it looks like thin
wood, by the last: wood that crosses stays."""
BEYOND_M = 0.10
"""It goes on for so much beyond what was found of it."""
BIN_M, LONG_M, FILLED = 0.05, 1.5, 0.5
"""It is seen along so many metres, in steps of the first, and over so large a share of its way."""
THIN_M = 0.009
"""Its radius is at most so large."""
MOST = 8
"""So many wires at most."""


@dataclass(frozen=True, eq=False)
class Line:
    """A line through `point` (3,) along `way` (3,), a unit vector."""

    point: Floats
    way: Floats

    def along(self, xyz: Floats) -> Floats:
        """Where along it each of some points (V, 3) lies, metres."""
        return np.asarray((xyz - self.point) @ self.way)

    def away(self, xyz: Floats) -> Floats:
        """How far from it each of some points (V, 3) lies, metres."""
        off = xyz - self.point
        return np.asarray(np.sqrt(np.maximum((off**2).sum(axis=1) - self.along(xyz) ** 2, 0.0)))

    def bins(self, xyz: Floats) -> int:
        """In how many steps of its way one of the points is near."""
        near = self.away(xyz) <= STRAIGHT_M
        return len(np.unique(np.floor(self.along(xyz[near]) / BIN_M)))

    def fitted(self, xyz: Floats) -> Line:
        """The line that fits best those of the points that are near."""
        near = xyz[self.away(xyz) <= STRAIGHT_M]
        middle = near.mean(axis=0)
        return Line(middle, np.linalg.svd(near - middle, full_matrices=False)[2][0])


def without_wires(field: PointField, rng: np.random.Generator) -> PointField:
    """The field with what lies on wires for no wood."""
    wire = on_wires(field, rng)
    role = field.role.copy()
    role[wire] = 0.0
    role[wire, Role.NO_WOOD] = 1.0
    return replace(field, role=role)


def on_wires(field: PointField, rng: np.random.Generator) -> Bools:
    """Which voxels (V,) of a field lie on wires."""
    axis, way = field.xyz + field.offset, field.toward_foot
    found = np.zeros(len(axis), np.bool_)
    heavy = field.role[:, [Role.STEM, Role.FRAMEWORK]].sum(axis=1) >= HEAVY
    thin = field.role[:, : Role.LATERAL].sum(axis=1) < HEAVY
    least = np.where(thin, THIN_ALONG_COS, ALONG_COS)
    left = np.flatnonzero((np.hypot(way[:, 0], way[:, 1]) >= LEVEL_COS) & ~heavy)
    for _ in range(MOST):
        line = _longest_line(axis[rng.permutation(left)[:ENOUGH]], rng)
        if line is None:
            break
        line = line.fitted(axis[left]).fitted(axis[left])
        near = line.away(axis[left]) <= STRAIGHT_M
        along = line.along(axis[left][near])
        seen = line.bins(axis[left]) * BIN_M
        if seen < LONG_M or seen < FILLED * np.ptp(along):
            break
        if np.median(field.radius[left][near]) <= THIN_M:
            at = line.along(axis)
            on = (line.away(axis) <= BLURRED_M) & (np.abs(way @ line.way) >= least)
            found |= on & (at >= along.min() - BEYOND_M) & (at <= along.max() + BEYOND_M)
        left = left[~near]
    return found


def _longest_line(xyz: Floats, rng: np.random.Generator) -> Line | None:
    """Of the lines through two of the points (V, 3) that with points near most of its way."""
    if len(xyz) < LONG_M / BIN_M:
        return None
    first, second = rng.integers(len(xyz), size=(2, GUESSES))
    step = xyz[second] - xyz[first]
    level = np.hypot(step[:, 0], step[:, 1])
    fits = (level >= APART_M) & (np.abs(step[:, 2]) <= STEEPEST * level)
    lines = [
        Line(xyz[row], way / np.linalg.norm(way))
        for row, way in zip(first[fits], step[fits], strict=True)
    ]
    return max(lines, key=lambda line: line.bins(xyz), default=None)
