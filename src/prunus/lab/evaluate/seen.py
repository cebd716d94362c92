"""What of a true tree a scan shows."""

from __future__ import annotations

import numpy as np

from prunus.geometry.near import within
from prunus.model import Bools, Floats, Ints, Skeleton
from prunus.model.branches import branches

COUNTS = 0.10
"""Shorter branches do not count, metres."""
SEEN = 0.05
"""Wood is seen where a point of its branch is within so many metres."""
HALF = 0.5
"""Branches of which less is seen do not count."""


def shown(tree: Skeleton, counting: Bools) -> Skeleton:
    """What of a tree a scan shows: the rows (M,) that count, and those that lead to them."""
    kept = counting.copy()
    kept[0] = True
    for row in range(len(tree) - 1, 0, -1):
        kept[tree.parent[row]] |= kept[row]
    return tree.part(kept)


def counting_rows(tree: Skeleton, points: Floats, branch: Ints) -> Bools:
    """Which rows (M,) of a tree count, given the points (P, 3) of it and their branches (P,)."""
    counting = np.zeros(len(tree), np.bool_)
    for number, one in enumerate(branches(tree)):
        rows = one.rows[1:]
        start, _ = within(points[branch == number], tree.xyz[rows], SEEN)
        seen = np.flatnonzero(np.diff(start))
        if len(seen) == 0:
            continue
        held = rows[seen[0] : seen[-1] + 1]
        long = tree.lengths[held].sum() >= COUNTS - 1e-9
        counting[held] = long and len(seen) >= HALF * len(held)
    return counting
