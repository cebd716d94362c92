"""Rank, with ties averaged (sec. Proposing and resampling candidate skeletons)."""

import numpy as np

from prunus.geometry.compiled import kernel
from prunus.model.arrays import Floats, Ints

FEW = 32
"""Up to this many values, counting the smaller ones is faster than sorting (1.0 -> 0.2 us at 8)."""


@kernel
def average_ranks(values: Floats, copies: Ints, ranks: Floats) -> None:
    """Write the Rank of each value (X,) in (0, 1] into `ranks`; value x stands `copies[x]` times.

    {4, 5, 5, 3, 7} gives {2/5, 7/10, 7/10, 1/5, 1}.
    """
    total = copies.sum()
    if len(values) <= FEW:
        for x in range(len(values)):
            below, tied = 0, 0
            for other in range(len(values)):
                below += copies[other] * (values[other] < values[x])
                tied += copies[other] * (values[other] == values[x])
            ranks[x] = (below + (tied + 1) / 2.0) / total
        return
    order = np.argsort(values)
    below, first = 0, 0
    while first < len(order):
        last, tied = first, 0
        while last < len(order) and values[order[last]] == values[order[first]]:
            tied += copies[order[last]]
            last += 1
        for slot in range(first, last):
            ranks[order[slot]] = (below + (tied + 1) / 2.0) / total
        below += tied
        first = last
