"""How far points are from one line of nodes, however far apart its nodes stand."""

import numpy as np

from prunus.kernels.compiled import kernel
from prunus.model.arrays import Floats

TINY = 1e-18


@kernel
def away_from(points: Floats, line: Floats) -> Floats:
    """The distance (N,) of points (N, 3) from a line of nodes (R, 3), R >= 1."""
    N, R = len(points), len(line)
    away = np.empty(N)
    for n in range(N):
        least = 0.0
        for axis in range(3):
            least += (points[n, axis] - line[0, axis]) ** 2
        for r in range(R - 1):
            along, length = 0.0, 0.0
            for axis in range(3):
                step = line[r + 1, axis] - line[r, axis]
                along += step * (points[n, axis] - line[r, axis])
                length += step * step
            share = min(max(along / max(length, TINY), 0.0), 1.0)
            square = 0.0
            for axis in range(3):
                here = line[r, axis] + share * (line[r + 1, axis] - line[r, axis])
                square += (points[n, axis] - here) ** 2
            least = min(least, square)
        away[n] = np.sqrt(least)
    return away
