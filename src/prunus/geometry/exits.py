"""Where a branch comes out of the wood of its parent."""

from __future__ import annotations

import numpy as np

from prunus.geometry.near import away_from
from prunus.model.arrays import Floats

STEP_M = 0.002
"""The place is looked for in such steps,"""
NEAR_M = 0.30
"""no farther along the branch."""
TURN_STEPS = 25
"""A branch at the end of its parent goes the way of its first so many steps,"""
GOES_ON_COS = 0.7
"""and goes on where the cosine of its turn is over this: 45 degrees."""


def exit_along(line: Floats, along: Floats, parent: Floats, radius: float) -> float:
    """How far along a branch, in metres, its axis is first `radius` away from its parent's axis.

    line (R, 3) begins on the parent's axis (Q, 3), along (R,) metres from there. 0 where it goes on
    from the parent's end: there is no wood to come out of; all of it where it never comes out.
    """
    length = float(along[-1])
    if length <= 0:
        return 0.0
    steps = np.arange(0.0, min(length, NEAR_M), STEP_M)
    points = np.column_stack([np.interp(steps, along, line[:, axis]) for axis in range(3)])
    if _goes_on(points, parent):
        return 0.0
    away = away_from(points, stretch_near(parent, line[0]))
    first = int((away >= radius).argmax())
    if first == 0:
        return length
    return float(np.interp(radius, away[first - 1 : first + 1], steps[first - 1 : first + 1]))


def _goes_on(points: Floats, parent: Floats) -> bool:
    """Whether points (N, 3) along a branch lie ahead of the end of its parent."""
    if len(parent) < 2 or not (points[0] == parent[-1]).all():
        return False
    own = points[min(TURN_STEPS, len(points) - 1)] - points[0]
    on = parent[-1] - parent[-2]
    return bool(own @ on > GOES_ON_COS * np.linalg.norm(own) * np.linalg.norm(on))


def stretch_near(line: Floats, place: Floats) -> Floats:
    """The stretch of a line (R, 3) that comes near a place (3,) on it or beside it."""
    rows = np.flatnonzero(((line - place) ** 2).sum(axis=1) <= (2 * NEAR_M) ** 2)
    low, high = (rows[0], rows[-1]) if len(rows) else (0, len(line))
    return line[max(low - 1, 0) : high + 2]
