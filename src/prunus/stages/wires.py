"""Trellis wires: thin, straight, level, and longer than any branch (beyond the paper).

Wood grows crooked: over two metres no branch keeps to a line within a finger's breadth,
and no support does so level. What does is a wire, however thick the camera drew it. Only what runs
along it is the wire's; leaders cross it, and side branches that touch it run another way.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from prunus.geometry.near import nearest
from prunus.model import Bools, Floats, Ints

LEVEL = np.cos(np.radians(20))
"""A wire is looked for in what runs along the row, by so much of its direction at least."""
ALIKE = np.cos(np.radians(50))
"""What lies on a wire once found is the wire's, if it runs along by so much: leaders stay."""
STEEPEST = 0.09
"""A wire rises no more than so many metres a metre, nor does it go deeper by twice as many."""
THICK = 0.018
"""A wire is straight but for so many metres."""
BLURRED = 0.035
"""What a camera drew of a wire is so near to it, metres."""
CROSSES = (0.045, 0.07)
"""What crosses a wire goes on at least so far from it, metres, within so many of where it lies."""
APART = 0.80
"""A wire is guessed from two points at least so far apart, metres."""
BIN = 0.05
LONG = 2.0
"""A wire is seen along so many metres at least, in steps of `BIN`."""
FILLED = 0.6
"""And along so large a share of its way."""
MOST = 8
GUESSES = 1500
CHUNK = 250


def on_wires(xyz: Floats, along: Floats, rng: np.random.Generator) -> Bools:
    """Which points (Q, 3), drawn together onto axes with directions (Q, 3), lie on wires."""
    found = np.zeros(len(xyz), np.bool_)
    left = np.flatnonzero(np.abs(along[:, 0]) >= LEVEL)
    for _ in range(MOST):
        if len(left) < LONG / BIN:
            break
        on = _best_line(xyz[left], rng).near(xyz[left])
        if on.sum() < LONG / BIN:
            break
        wire = _Line.fitted(xyz[left][on])
        on = wire.near(xyz[left])
        if not _is_wire(xyz[left][on, 0]):
            break
        found |= wire.near(xyz, BLURRED) & ~_crossing(wire, xyz, along)
        left = left[~on]
    return found


def _crossing(wire: _Line, xyz: Floats, along: Floats) -> Bools:
    """Which points (Q, 3) run across a wire, and are not its fringe: wood goes on beside them."""
    beyond = xyz[~wire.near(xyz, CROSSES[0])]
    goes_on = nearest(xyz, beyond, CROSSES[1]) >= 0
    return np.asarray(goes_on & (np.abs(along[:, 0]) < ALIKE))


@dataclass(frozen=True, eq=False)
class _Line:
    """Depth and height along the row: polynomials of X, highest power first."""

    depth: Floats
    height: Floats

    @classmethod
    def fitted(cls, xyz: Floats) -> _Line:
        """A wire through points (Q, 3): it sags."""
        return cls(np.polyfit(xyz[:, 0], xyz[:, 1], 1), np.polyfit(xyz[:, 0], xyz[:, 2], 2))

    def near(self, xyz: Floats, reach: float = THICK) -> Bools:
        """Which points (Q, 3) are within so many metres of it."""
        depth = xyz[:, 1] - np.polyval(self.depth, xyz[:, 0])
        height = xyz[:, 2] - np.polyval(self.height, xyz[:, 0])
        return np.asarray(np.hypot(depth, height) <= reach)


def _best_line(xyz: Floats, rng: np.random.Generator) -> _Line:
    """The line through two of the points (Q, 3) that most bins of the row have points near."""
    first, second = rng.integers(len(xyz), size=(2, GUESSES))
    step = xyz[second] - xyz[first]
    wide = np.abs(step[:, 0]) >= APART
    first, step = first[wide], step[wide]
    slope = step[:, 1:] / step[:, :1]
    fits = (np.abs(slope) <= [2 * STEEPEST, STEEPEST]).all(axis=1)
    first, slope = first[fits], slope[fits]
    if len(first) == 0:
        return _Line(np.zeros(1), np.full(1, np.inf))
    best = int(np.argmax(_bins_filled(xyz, first, slope)))
    at = xyz[first[best]]
    lines = [np.array([s, at[k] - s * at[0]]) for k, s in enumerate(slope[best], 1)]
    return _Line(*lines)


def _bins_filled(xyz: Floats, first: Ints, slope: Floats) -> Ints:
    """How many bins of the row have points near each line (G,)."""
    bins = ((xyz[:, 0] - xyz[:, 0].min()) / BIN).astype(np.int64)
    order = np.argsort(bins, kind="stable")
    starts = np.unique(bins[order], return_index=True)[1]
    counts = []
    for rows in np.array_split(np.arange(len(first)), max(1, len(first) // CHUNK)):
        away = xyz[None, order, 1:] - xyz[first[rows], None, 1:]
        away -= (xyz[None, order, :1] - xyz[first[rows], None, :1]) * slope[rows, None]
        near = (away**2).sum(axis=2) <= THICK**2
        counts.append(np.logical_or.reduceat(near, starts, axis=1).sum(axis=1))
    return np.concatenate(counts)


def _is_wire(x: Floats) -> bool:
    """Whether points at these places of the row cover enough of it."""
    if len(x) == 0:
        return False
    seen = len(np.unique((x / BIN).astype(np.int64))) * BIN
    return bool(seen >= LONG and seen >= FILLED * np.ptp(x))
