"""Rank, with ties averaged (sec. Proposing and resampling candidate skeletons)."""

import numpy as np

from prunus.kernels.compiled import kernel
from prunus.model.arrays import Floats, Ints


@kernel
def average_ranks(values: Floats, copies: Ints) -> Floats:
    """Rank (X,) of each value in (0, 1], where value x stands `copies[x]` times in the list.

    {4, 5, 5, 3, 7} gives {2/5, 7/10, 7/10, 1/5, 1}.
    """
    order = np.argsort(values)
    ranks = np.empty(len(values))
    total = copies.sum()
    below = 0
    first = 0
    while first < len(order):
        last = first
        tied = 0
        while last < len(order) and values[order[last]] == values[order[first]]:
            tied += copies[order[last]]
            last += 1
        for slot in range(first, last):
            ranks[order[slot]] = (below + (tied + 1) / 2.0) / total
        below += tied
        first = last
    return ranks
