"""Cones about directions: how near to each of them anything stands."""

import numpy as np

from prunus.kernels.compiled import kernel
from prunus.model.arrays import Floats


@kernel
def greatest_cosines(ways: Floats, off: Floats, away: Floats) -> Floats:
    """The greatest cosine (D,) of unit directions (D, 3) with points off (Q, 3), away (Q,) far.

    -1 where there is none.
    """
    found = np.full(len(ways), -1.0)
    for q in range(len(off)):
        x, y, z = off[q, 0] / away[q], off[q, 1] / away[q], off[q, 2] / away[q]
        for d in range(len(ways)):
            cosine = ways[d, 0] * x + ways[d, 1] * y + ways[d, 2] * z
            if cosine > found[d]:
                found[d] = cosine
    return found
