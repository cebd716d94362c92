"""Where lines leave the lines that they hang on.

S stations stand along B lines, those of line b in the rows start[b] to start[b + 1]; line b leaves
line parent[b], or none (-1).
"""

from __future__ import annotations

import numpy as np
from scipy.spatial.distance import cdist

from prunus.model import Bools, Floats, Ints

TINY = 1e-12


def within_parents(xyz: Floats, start: Ints, parent: Ints, half: Floats) -> Bools:
    """Which stations (S,) at the foot of a line lie in the wood of its parent, `half` (S,) thick.

    The last two stations of a line never do.
    """
    inside = np.zeros(len(xyz), np.bool_)
    for b, p in enumerate(parent.tolist()):
        own = slice(start[b], max(start[b + 1] - 2, start[b]))
        if p < 0 or own.start == own.stop:
            continue
        square = cdist(xyz[own], xyz[start[p] : start[p + 1]], "sqeuclidean")
        near = square.argmin(axis=1)
        wood = half[start[p] + near] ** 2
        inside[own] = np.logical_and.accumulate(square.min(axis=1) < wood)
    return inside


def feet(
    xyz: Floats,
    start: Ints,
    parent: Ints,
    inside: Bools,
    *,
    home: Floats,
    usual: Floats,
    err: Floats,
    ahead: int,
    slide: int,
) -> Ints:
    """The station (B,) of the parent from which each line starts; -1 where it has no parent.

    The line is led back straight from its first station outside the parent's wood, in the
    direction of the next `ahead` stations. Of the parent's stations up to `slide` from where it
    left at `home` (B, 3), the likeliest is chosen: near the straight line, at a usual angle, and
    near home. usual (B, 2 or more): the angle between parent and line, radians, and its standard
    deviation; err (B, 2): standard deviations of the distances from line and home, metres.
    """
    hung = np.flatnonzero(parent >= 0)
    low, high = start[parent[hung]], start[parent[hung] + 1]
    now = [low[i] + ((xyz[low[i] : high[i]] - home[b]) ** 2).sum(axis=1).argmin()
           for i, b in enumerate(hung)]  # fmt: skip
    station = np.array(now, np.int64)[:, None] + np.arange(-slide, slide + 1)
    possible = (station > low[:, None]) & (station < high[:, None] - 1)
    station = np.where(possible, station, low[:, None])
    out = xyz[_first_outside(start, inside)[hung]]
    way = _headings(xyz, start, inside, ahead)[hung]
    step = xyz[station] - out[:, None]
    on = xyz[np.minimum(station + 1, len(xyz) - 1)] - xyz[np.maximum(station - 1, 0)]
    away, back = (step**2).sum(axis=2), (step * way[:, None]).sum(axis=2)
    size = np.sqrt(away * (on**2).sum(axis=2))
    angle = np.arccos(np.clip(-(step * on).sum(axis=2) / np.maximum(size, TINY), -1.0, 1.0))
    moved = ((xyz[station] - home[hung][:, None]) ** 2).sum(axis=2)
    cost = (away - np.minimum(back, 0.0) ** 2) / err[hung, :1] ** 2 + moved / err[hung, 1:2] ** 2
    cost += ((angle - usual[hung, :1]) / usual[hung, 1:2]) ** 2
    best = np.where(possible, cost, np.inf).argmin(axis=1)
    likeliest = station[np.arange(len(hung)), best]
    foot = np.full(len(parent), -1, np.int64)
    foot[hung] = np.where(possible.any(axis=1), likeliest, high - 1)
    return foot


def _first_outside(start: Ints, inside: Bools) -> Ints:
    """The first station (B,) of each line outside its parent's wood, of all but the last two."""
    out = start[:-1].copy()
    last = np.maximum(start[1:] - 2, out)
    for b, end in enumerate(last.tolist()):
        led = np.flatnonzero(~inside[out[b] : end])
        out[b] = out[b] + led[0] if len(led) else end
    return np.asarray(out)


def _headings(xyz: Floats, start: Ints, inside: Bools, ahead: int) -> Floats:
    """The direction (B, 3) of so many stations of each line outside its parent's wood."""
    out = _first_outside(start, inside)
    way = xyz[np.minimum(out + ahead, start[1:] - 1)] - xyz[out]
    return np.asarray(way / np.maximum(np.linalg.norm(way, axis=1, keepdims=True), TINY))
