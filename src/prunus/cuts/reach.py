"""The way of a tool to a cut: which directions from the camera's side are free of points.

What the scan does not show cannot stand in the way here: a free cone says that the cameras, which
stood on that side, saw nothing in it.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from prunus.cuts.nearby import AROUND_M
from prunus.geometry.near import nearest
from prunus.model import Floats, Ints
from prunus.model.arrays import cubes

FREE = AROUND_M
"""A way is looked at from so far away, metres."""
AT_BLADE = 0.02
"""Points so near to the cut are the wood that is cut, metres."""
SMEAR = 0.015
"""Points so near to the wood that comes down are taken for it, metres."""
THIN = 0.010
"""One point in cubes of this side is looked at, metres, and stands for half of it."""
SHELLS = (AT_BLADE, 0.05, 0.12, FREE)
"""Points between two of these distances, metres, are taken to be as thick as the nearest."""
ENOUGH = 30.0
"""A wider free cone is no better, degrees."""
OBLIQUE = 45.0
"""A blade is at most so far from square to the branch, degrees."""
BEHIND = 10.0
"""A tool comes at least so many degrees from in front of the plane of the row."""
DIRECTIONS = 600
"""Directions of the sphere that are tried, those from behind left out: some 9 degrees apart."""
SQUARE, FRONT = 0.2, 0.1
"""A degree away from square, or from straight ahead, is worth so many degrees of free cone."""


@dataclass(frozen=True)
class Approach:
    """How a tool comes to a cut: the unit direction in which it moves, house frame.

    No point lies within `half_angle` degrees of the way it comes, as seen from the cut, up to
    `free_within` metres; where not even a thin way is free, that is where the first point lies.
    """

    direction: tuple[float, float, float]
    half_angle: float
    free_within: float


def ways() -> Floats:
    """Unit directions (D, 3), house frame, from a cut to where a tool may come from: smaller Y.

    Those of a Fibonacci sphere: even, without poles.
    """
    steps = np.arange(DIRECTIONS) + 0.5
    y = 1 - 2 * steps / DIRECTIONS
    turn = np.pi * (1 + np.sqrt(5)) * steps
    ring = np.sqrt(1 - y**2)
    sphere = np.column_stack([ring * np.cos(turn), y, ring * np.sin(turn)])
    return np.asarray(sphere[y <= -np.sin(np.radians(BEHIND))])


WAYS = ways()


def approach(point: Floats, heading: Floats, points: Floats, removed: Floats) -> Approach:
    """The best way to a cut at a point (3,) of a branch that goes on along a heading (3,).

    `points` (Q, 3) stand in the way, save those of the `removed` wood, given as samples (S, 3).
    Where no way is free, the best of them has no cone.
    """
    off, away = _in_the_way(point, points, removed)
    square = np.degrees(np.arcsin(np.clip(np.abs(WAYS @ heading), 0, 1)))
    rows = np.flatnonzero(square <= OBLIQUE)
    free = _free_angles(WAYS[rows], off, away)
    front = np.degrees(np.arccos(np.clip(-WAYS[rows, 1], -1, 1)))
    worth = np.minimum(free, ENOUGH) - SQUARE * square[rows] - FRONT * front
    best = int(worth.argmax())
    way = WAYS[rows[best]]
    clear = FREE if free[best] > 0 else _first(way, off, away)
    x, y, z = (-way).tolist()
    return Approach((x, y, z), float(free[best]), clear)


def blade_normal(heading: Floats, direction: Floats) -> Floats:
    """The normal (3,) of a blade that moves along a direction: as near to the heading as can be."""
    normal = heading - (heading @ direction) * direction
    return np.asarray(normal / np.linalg.norm(normal))


def _in_the_way(point: Floats, points: Floats, removed: Floats) -> tuple[Floats, Floats]:
    """From a cut to the points that may stand in the way (Q, 3), thinned, and how far (Q,)."""
    away = np.linalg.norm(points - point, axis=1)
    some = points[(away > AT_BLADE) & (away < FREE)]
    if len(some):
        _, first = np.unique(cubes(some, THIN), return_index=True)
        some = some[first]
    if len(some) and len(removed):
        some = some[nearest(some, removed, SMEAR) < 0]
    off = some - point
    return off, np.linalg.norm(off, axis=1)


def _free_angles(ways: Floats, off: Floats, away: Floats) -> Floats:
    """The half angle (D,), degrees, of the cone about each way that holds no point; 0 to 90."""
    cosine = np.array([_most(ways, off, away, *shell) for shell in pairwise(SHELLS)])
    thick = np.arcsin(THIN / 2 / np.array(SHELLS[:-1]))
    angle = np.arccos(np.clip(cosine, -1, 1)) - thick[:, None]
    return np.asarray(np.degrees(np.clip(angle.min(axis=0), 0, np.pi / 2)))


def _most(ways: Floats, off: Floats, away: Floats, low: float, high: float) -> Floats:
    """The greatest cosine (D,) of each way with points between two distances; -1 without any."""
    rows = np.flatnonzero((away >= low) & (away < high))
    return np.asarray((ways @ (off[rows] / away[rows, None]).T).max(axis=1, initial=-1.0))


def _first(way: Floats, off: Floats, away: Floats) -> float:
    """The distance of the nearest point that touches a way."""
    along = off @ way
    beside = np.sqrt(np.maximum(away**2 - along**2, 0))
    hit = (along > 0) & (beside <= THIN)
    return float(away[hit].min()) if hit.any() else FREE


def samples(xyz: Floats, parent: Ints, rows: Ints) -> Floats:
    """Points (S, 3) every centimetre or less along the edges that end in some rows."""
    if len(rows) == 0:
        return np.zeros((0, 3))
    step = xyz[rows] - xyz[parent[rows]]
    count = np.maximum(np.ceil(np.linalg.norm(step, axis=1) / 0.01).astype(int), 1)
    edge = np.repeat(np.arange(len(rows)), count)
    first = np.concatenate([[0], count.cumsum()[:-1]])
    share = (np.arange(len(edge)) - first[edge] + 1) / count[edge]
    return np.asarray(xyz[parent[rows]][edge] + share[:, None] * step[edge])
