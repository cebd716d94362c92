"""Whether wood was seen from one side or from all around, as its own points tell.

Points of the side that faces the cameras lie on an arc: at the middle of the ribbon all are about
equally deep. Those of wood seen from all around lie there in front and behind.
"""

from __future__ import annotations

import numpy as np

from prunus.model import Floats
from prunus.refine.centrelines import Centrelines
from prunus.refine.ribbons import Ribbons

ONE_SIDE, ALL_AROUND = 0.58, 0.68
"""So deep are points along the middle, as a share of half the width: from there, not from one side
alone; from here, from all around. Wood seen from one side shows 0.2, in a field scan 0.4 to 0.6; a
ring 0.76, in noise a third of its radius 0.68."""
MIN_OWN_WIDTH = 3.0
"""Half width over noise from which a branch tells by itself from how many sides it is seen."""
MIN_SHARED_WIDTH = 2.0
"""Half width over noise from which it adds to what is told for all thin wood of the tree."""
MIN_HALF_WIDTH_M = 0.009
"""Thinner ribbons tell nothing."""
ROUNDER = 0.088
"""A ribbon seen from all around is wider by this share: its edges are seen twice."""


def seen_around(lines: Centrelines, ribbons: Ribbons, noise: float) -> Floats:
    """How far each line (B,) was seen from all around: 0 from one side, 1 from all around."""
    half = np.array([_usual(part) for part in np.split(ribbons.half, lines.start[1:-1])])
    size = np.bincount(lines.line, ribbons.count) * half**2
    helps = half >= max(MIN_SHARED_WIDTH * noise, MIN_HALF_WIDTH_M)
    if not helps.any():
        return np.zeros(len(half))
    together = np.sqrt(np.average(ribbons.deep[helps] ** 2, weights=size[helps]))
    deep = np.where(half >= max(MIN_OWN_WIDTH * noise, MIN_HALF_WIDTH_M), ribbons.deep, together)
    return np.asarray(np.clip((deep - ONE_SIDE) / (ALL_AROUND - ONE_SIDE), 0.0, 1.0))


def _usual(half: Floats) -> float:
    """The middle of the known half widths of a line; 0 where none is known."""
    known = half[np.isfinite(half)]
    return float(np.median(known)) if len(known) else 0.0
