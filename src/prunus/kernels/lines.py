"""Points on lines: the nearest place of a set of polylines, and smooth lines through points.

S stations stand along B lines, those of line b in the rows start[b] to start[b + 1].
"""

import numpy as np

from prunus.kernels.compiled import kernel
from prunus.kernels.neighbours import ball, build_grid
from prunus.model.arrays import Floats, Ints

TINY = 1e-12


@kernel
def nearest_on_lines(
    xyz: Floats, station: Floats, line: Ints, reach: float
) -> tuple[Ints, Floats, Floats]:
    """The place of the lines nearest to each point (P, 3) that has a station within `reach`.

    It is `share` (P,) of the way from station `before` (P,) to the next of its `line` (S,), and
    `away` (P,) from the point; `before` is -1 where no station is within reach. Of the lines only
    the pieces at the nearest station are looked at.
    """
    P, S = len(xyz), len(station)
    grid = build_grid(station, reach)
    found = np.empty(S, np.int64)
    before, share, away = np.full(P, -1, np.int64), np.zeros(P), np.full(P, np.inf)
    for p in range(P):
        best, least = -1, np.inf
        for slot in range(ball(station, grid, xyz[p], reach, found)):
            s = found[slot]
            x = station[s, 0] - xyz[p, 0]
            y = station[s, 1] - xyz[p, 1]
            z = station[s, 2] - xyz[p, 2]
            square = x * x + y * y + z * z
            if square < least or (square == least and s < best):
                best, least = s, square
        if best < 0:
            continue
        for s in range(max(best - 1, 0), min(best + 1, S - 1)):
            if line[s] != line[s + 1]:
                continue
            along, length = 0.0, 0.0
            for a in range(3):
                step = station[s + 1, a] - station[s, a]
                along += step * (xyz[p, a] - station[s, a])
                length += step * step
            at = min(max(along / max(length, TINY), 0.0), 1.0)
            square = 0.0
            for a in range(3):
                here = station[s, a] + at * (station[s + 1, a] - station[s, a])
                square += (xyz[p, a] - here) ** 2
            if square < away[p]:
                before[p], share[p], away[p] = s, at, square
    return before, share, np.sqrt(away)


@kernel
def solve_five(diagonal: Floats, beside: Floats, beyond: Floats, right: Floats) -> Floats:
    """Solve A x = right (S, C), A symmetric, positive definite and of five diagonals.

    A[s, s] is `diagonal` (S,), A[s, s + 1] `beside` (S,) and A[s, s + 2] `beyond` (S,); the last
    one and the last two of these are not looked at.
    """
    S, C = right.shape
    d, l1, l2 = np.zeros(S), np.zeros(S), np.zeros(S)
    x = right.copy()
    for s in range(S):
        d[s] = diagonal[s]
        if s >= 1:
            d[s] -= l1[s - 1] ** 2 * d[s - 1]
        if s >= 2:
            d[s] -= l2[s - 2] ** 2 * d[s - 2]
        if s + 1 < S:
            l1[s] = beside[s]
            if s >= 1:
                l1[s] -= l2[s - 1] * d[s - 1] * l1[s - 1]
            l1[s] /= d[s]
        if s + 2 < S:
            l2[s] = beyond[s] / d[s]
        for c in range(C):
            if s >= 1:
                x[s, c] -= l1[s - 1] * x[s - 1, c]
            if s >= 2:
                x[s, c] -= l2[s - 2] * x[s - 2, c]
    for s in range(S - 1, -1, -1):
        for c in range(C):
            x[s, c] /= d[s]
            if s + 1 < S:
                x[s, c] -= l1[s] * x[s + 1, c]
            if s + 2 < S:
                x[s, c] -= l2[s] * x[s + 2, c]
    return x
