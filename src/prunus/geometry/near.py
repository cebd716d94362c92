"""Points within a radius, nearest points, and distances from lines."""

from __future__ import annotations

from itertools import chain

import numpy as np
from scipy.spatial import cKDTree

from prunus.model.arrays import Floats, Ints

TINY = 1e-18


def within(xyz: Floats, centers: Floats, radius: float) -> tuple[Ints, Ints]:
    """Points within `radius` of each center (N, 3), sorted: starts (N + 1,) and point indices."""
    if len(xyz) == 0 or len(centers) == 0:
        return np.zeros(len(centers) + 1, np.int64), np.zeros(0, np.int64)
    found = cKDTree(xyz).query_ball_point(centers, radius, return_sorted=True)
    start = np.zeros(len(centers) + 1, np.int64)
    np.cumsum([len(some) for some in found], out=start[1:])
    return start, np.fromiter(chain.from_iterable(found), np.int64, start[-1])


def nearest(xyz: Floats, nodes: Floats, reach: float) -> Ints:
    """The node nearest to each point (P,); -1 where none of them (N, 3) is within `reach`."""
    return nearest_and_away(xyz, nodes, reach)[0]


def nearest_and_away(xyz: Floats, nodes: Floats, reach: float) -> tuple[Ints, Floats]:
    """The same, and how far each point (P,) is from it; infinity where there is none."""
    if len(xyz) == 0 or len(nodes) == 0:
        return np.full(len(xyz), -1), np.full(len(xyz), np.inf)
    beyond = np.nextafter(reach, np.inf)  # the tree takes what is nearer than its bound
    away, found = cKDTree(nodes).query(xyz, distance_upper_bound=beyond)
    return np.where(np.isfinite(away), found, -1).astype(np.int64), np.asarray(away)


def away_from(points: Floats, line: Floats) -> Floats:
    """The distance (N,) of points (N, 3) from a line of nodes (R, 3), R >= 1."""
    foot, step = (line[:-1], np.diff(line, axis=0)) if len(line) > 1 else (line, 0 * line)
    off = points[:, None] - foot
    along = (off * step).sum(axis=2) / np.maximum((step**2).sum(axis=1), TINY)
    off -= np.clip(along, 0.0, 1.0)[:, :, None] * step
    return np.asarray(np.sqrt((off**2).sum(axis=2).min(axis=1)))
