"""Draw a cloud together onto the axes of its branches.

Each point goes to the line that best fits the points around it, across that line only; after a
few rounds a branch is as thin as a thread, and where branches meet the threads meet.
"""

import numpy as np

from prunus.geometry.compiled import kernel
from prunus.geometry.neighbours import within
from prunus.model.arrays import GRID, Floats

TINY = 1e-12


@kernel
def main_axis(spread: Floats, axis: Floats) -> float:
    """Write the main direction of a second moment (3, 3) into `axis`; how much it is a line.

    The first principal component (PCA); how much is 1 - the second greatest spread over the
    greatest: 1 for a line, 0 for a disc or a ball.
    By squaring: the greatest eigenvalue of spread^64 leaves nothing of the others.
    """
    power = spread / max(spread[0, 0] + spread[1, 1] + spread[2, 2], TINY)
    for _ in range(6):
        power = power @ power
        power = power / max(power[0, 0] + power[1, 1] + power[2, 2], TINY)
    column = 0
    for c in range(1, 3):
        if power[c, c] > power[column, column]:
            column = c
    length = np.sqrt((power[:, column] ** 2).sum())
    axis[:] = power[:, column] / max(length, TINY)
    greatest = (axis * (spread @ axis)).sum()
    rest = spread[0, 0] + spread[1, 1] + spread[2, 2] - greatest
    squares = (spread * spread).sum() - greatest * greatest
    second = (rest + np.sqrt(max(2 * squares - rest * rest, 0.0))) / 2
    return float(1 - second / max(greatest, TINY))


@kernel
def contract(
    xyz: Floats, weight: Floats, radius: float, rounds: int
) -> tuple[Floats, Floats, Floats, Floats, Floats]:
    """Points (P, 3) of some weights (P,) drawn together in so many rounds.

    Returns where they go (P, 3), on the grid of `model.arrays`, the direction of the branch (P, 3),
    how much its surroundings are a line (P,), in [0, 1], how far to one side of it along that line
    they lie (P,), in radii, and the weight around (P,).
    """
    P = len(xyz)
    here = xyz.copy()
    axis, line = np.zeros((P, 3)), np.zeros(P)
    aside, around = np.zeros(P), np.zeros(P)
    mean, spread = np.empty(3), np.empty((3, 3))
    for _ in range(rounds):
        start, members = within(here, here, radius)
        there = here.copy()
        for p in range(P):
            mean[:], spread[:] = 0.0, 0.0
            total = 0.0
            for slot in range(start[p], start[p + 1]):
                q = members[slot]
                x = here[q, 0] - here[p, 0]
                y = here[q, 1] - here[p, 1]
                z = here[q, 2] - here[p, 2]
                share = weight[q] * (1 - (x * x + y * y + z * z) / (radius * radius))
                total += share
                mean[0] += share * x
                mean[1] += share * y
                mean[2] += share * z
                spread[0, 0] += share * x * x
                spread[1, 1] += share * y * y
                spread[2, 2] += share * z * z
                spread[0, 1] += share * x * y
                spread[0, 2] += share * x * z
                spread[1, 2] += share * y * z
            around[p] = total
            mean /= total
            spread[1, 0], spread[2, 0], spread[2, 1] = spread[0, 1], spread[0, 2], spread[1, 2]
            spread /= total
            for a in range(3):
                for b in range(3):
                    spread[a, b] -= mean[a] * mean[b]
            line[p] = main_axis(spread, axis[p])
            along = (mean * axis[p]).sum()
            aside[p] = abs(along) / radius
            for a in range(3):
                moved = mean[a] - along * axis[p, a]
                there[p, a] += np.rint(moved / GRID) * GRID
        here = there
    return here, axis, line, aside, around
