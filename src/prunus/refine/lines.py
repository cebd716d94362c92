"""Points on lines: the nearest place of a set of polylines."""

from __future__ import annotations

import numpy as np

from prunus.geometry.near import nearest
from prunus.model import Floats, Ints

TINY = 1e-12


def nearest_on_lines(
    xyz: Floats, station: Floats, line: Ints, reach: float
) -> tuple[Ints, Floats, Floats]:
    """The place of the lines nearest to each point (P, 3) that has a station within `reach`.

    It is `share` (P,) of the way from station `before` (P,) to the next of its `line` (S,), and
    `away` (P,) from the point; `before` is -1 where no station is within reach. Of the lines only
    the pieces at the nearest station are looked at.
    """
    best = nearest(xyz, station, reach)
    before, share = np.full(len(xyz), -1, np.int64), np.zeros(len(xyz))
    away = np.full(len(xyz), np.inf)
    goes_on = np.append(line[1:] == line[:-1], False)
    step = np.diff(station, axis=0, append=station[-1:])
    square = np.maximum((step**2).sum(axis=1), TINY)
    for piece in (best - 1, best):
        row = np.flatnonzero((best >= 0) & (piece >= 0) & goes_on[np.maximum(piece, 0)])
        s = piece[row]
        off = xyz[row] - station[s]
        at = np.clip((off * step[s]).sum(axis=1) / square[s], 0.0, 1.0)
        far = np.linalg.norm(off - at[:, None] * step[s], axis=1)
        nearer = far < away[row]
        row, s, at, far = row[nearer], s[nearer], at[nearer], far[nearer]
        before[row], share[row], away[row] = s, at, far
    return before, share, away
