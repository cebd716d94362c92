"""Smooth lines through points: penalised least squares, all lines of a tree at once.

A Whittaker smoother over even stations; its normal equations have five diagonals.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solveh_banded

from prunus.model import Floats, Ints
from prunus.refine.centrelines import STEP, Centrelines

ERR = (0.004, 0.17)
"""Standard deviation of the middle of the points at one station: metres, a share of the noise."""
BENDS = 0.5
"""Lines turn by so much: mean square of the turn, radians, a metre."""
STAYS = 0.012
"""Standard deviation, metres, of a centimetre of line without points from where it was."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Shares:
    """Q points xyz (Q, 3), each `share` (Q,) of the way from station `before` (Q,) to the next.

    `weight` (Q,) is how much each counts.
    """

    xyz: Floats
    before: Ints
    share: Floats
    weight: Floats

    @property
    def station(self) -> Ints:
        """The nearer of the two stations (Q,)."""
        return self.before + (self.share > 0.5)

    def summed(self, values: Floats, stations: int) -> Floats:
        """Weighted sums (S,) of values (Q,) at the stations."""
        return np.asarray(np.bincount(self.station, self.weight * values, stations), np.float64)


@dataclass(frozen=True, eq=False)
class Ties:
    """Stations (F,) that are tied to places (F, 3), standard deviation `err` in metres."""

    station: Ints
    place: Floats
    err: float


def smoothed(lines: Centrelines, home: Floats, points: Shares, ties: Ties, noise: float) -> Floats:
    """The stations (S, 3) of smooth lines that pass through points and ties.

    What is least: the squared distance of the line from the points, in units of `ERR`, each station
    with as much say as any other that has points, but less where these lie far off and hardly
    count; the squared second differences (`BENDS`); the squared distance from home (S, 3)
    (`STAYS`), and of tied stations from their places.
    """
    size, middle = len(lines.xyz), lines.xyz[0]
    total = np.bincount(points.station, points.weight, size)
    say = points.weight / (total[points.station] + FEW) / (ERR[0] + ERR[1] * noise) ** 2
    say = say * (total / np.maximum(np.bincount(points.station, minlength=size), 1))[points.station]
    diagonal, beside = _of_points(points, say, size)
    right = np.column_stack([
        _spread(points, say * (points.xyz[:, axis] - middle[axis]), size) for axis in range(3)
    ])  # fmt: skip
    stays = STEP / STAYS**2
    diagonal += stays
    right += stays * (home - middle)
    diagonal[ties.station] += ties.err**-2
    right[ties.station] += ties.err**-2 * (ties.place - middle)
    beyond = _add_bending(lines, diagonal, beside)
    bands = np.array([diagonal, beside, beyond])  # as `solveh_banded` has them, lower
    return np.asarray(solveh_banded(bands, right, lower=True) + middle)


FEW = 3.0
"""A station with so many points has half the say of one with many."""


def _of_points(points: Shares, say: Floats, size: int) -> tuple[Floats, Floats]:
    first, second = 1 - points.share, points.share
    diagonal = np.bincount(points.before, say * first**2, size)
    diagonal = diagonal + np.bincount(points.before + 1, say * second**2, size)
    beside = np.bincount(points.before, say * first * second, size)
    return np.asarray(diagonal, np.float64), np.asarray(beside, np.float64)


def _spread(points: Shares, values: Floats, size: int) -> Floats:
    """Values (Q,) shared out to the two stations of each point."""
    low = np.bincount(points.before, values * (1 - points.share), size)
    high = np.bincount(points.before + 1, values * points.share, size)
    return np.asarray(low + high, np.float64)


def _add_bending(lines: Centrelines, diagonal: Floats, beside: Floats) -> Floats:
    """Add the second differences of each line to the first two diagonals; the third (S,)."""
    line, stiff = lines.line, 1 / (BENDS * STEP**3)
    whole = np.flatnonzero(line[:-2] == line[2:])
    for offset, share in enumerate((1, 4, 1)):
        diagonal[whole + offset] += share * stiff
    for offset in (0, 1):
        beside[whole + offset] -= 2 * stiff
    beyond = np.zeros(len(line))
    beyond[whole] = stiff
    return beyond
