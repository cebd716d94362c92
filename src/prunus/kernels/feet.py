"""Where lines leave the lines that they hang on.

S stations stand along B lines, those of line b in the rows start[b] to start[b + 1]; line b leaves
line parent[b], or none (-1).
"""

import numpy as np
from numpy.typing import NDArray

from prunus.kernels.compiled import kernel
from prunus.model.arrays import Floats, Ints

Flags = NDArray[np.bool_]
TINY = 1e-12


@kernel
def nearest_station(xyz: Floats, low: int, high: int, place: Floats) -> int:
    """The row from `low` to before `high` of xyz (S, 3) that is nearest to a place (3,)."""
    best, least = low, np.inf
    for s in range(low, high):
        square = 0.0
        for a in range(3):
            square += (xyz[s, a] - place[a]) ** 2
        if square < least:
            best, least = s, square
    return best


@kernel
def within_parents(xyz: Floats, start: Ints, parent: Ints, half: Floats) -> Flags:
    """Which stations (S,) at the foot of a line lie in the wood of its parent, `half` (S,) thick.

    The last two stations of a line never do.
    """
    inside = np.zeros(len(xyz), np.bool_)
    for b in range(len(parent)):
        p = parent[b]
        if p < 0:
            continue
        for s in range(start[b], start[b + 1] - 2):
            near = nearest_station(xyz, start[p], start[p + 1], xyz[s])
            square = 0.0
            for a in range(3):
                square += (xyz[near, a] - xyz[s, a]) ** 2
            if square >= half[near] ** 2:
                break
            inside[s] = True
    return inside


@kernel
def feet(
    xyz: Floats,
    start: Ints,
    parent: Ints,
    inside: Flags,
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
    B = len(parent)
    foot = np.full(B, -1, np.int64)
    way = np.empty(3)
    for b in range(B):
        p = parent[b]
        if p < 0:
            continue
        out = start[b]
        while out < start[b + 1] - 2 and inside[out]:
            out += 1
        far = min(out + ahead, start[b + 1] - 1)
        length = 0.0
        for a in range(3):
            way[a] = xyz[far, a] - xyz[out, a]
            length += way[a] ** 2
        way /= max(np.sqrt(length), TINY)
        now = nearest_station(xyz, start[p], start[p + 1], home[b])
        least = np.inf
        for s in range(max(now - slide, start[p] + 1), min(now + slide + 1, start[p + 1] - 1)):
            back, away, moved, rise, step_square = 0.0, 0.0, 0.0, 0.0, 0.0
            for a in range(3):
                step = xyz[s, a] - xyz[out, a]
                on = xyz[s + 1, a] - xyz[s - 1, a]
                back += step * way[a]
                away += step * step
                moved += (xyz[s, a] - home[b, a]) ** 2
                rise -= step * on
                step_square += on * on
            angle = np.arccos(min(max(rise / max(np.sqrt(away * step_square), TINY), -1.0), 1.0))
            cost = (away - min(back, 0.0) ** 2) / err[b, 0] ** 2 + moved / err[b, 1] ** 2
            cost += ((angle - usual[b, 0]) / usual[b, 1]) ** 2
            if cost < least:
                foot[b], least = s, cost
        if foot[b] < 0:
            foot[b] = start[p + 1] - 1
    return foot
