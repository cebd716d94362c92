"""Depth images, pixel by pixel: who has company at the same depth."""

import numpy as np

from prunus.geometry.compiled import kernel
from prunus.model.arrays import Floats, Ints


@kernel
def company(depth: Floats, slack: float) -> Ints:
    """How many of the eight neighbours of each pixel (H, W) lie at the same depth, 0 to 8.

    The same is where 1 / depth differs by no more than `slack` (1 / m), as stereo errs by so much
    whatever the depth. Pixels of depth 0 hold nothing and have no company.
    """
    H, W = depth.shape
    count = np.zeros((H, W), np.int64)
    for row in range(H):
        for column in range(W):
            if depth[row, column] <= 0.0:
                continue
            for r in range(max(row - 1, 0), min(row + 2, H)):
                for c in range(max(column - 1, 0), min(column + 2, W)):
                    if depth[r, c] <= 0.0 or (r == row and c == column):
                        continue
                    if abs(1.0 / depth[r, c] - 1.0 / depth[row, column]) <= slack:
                        count[row, column] += 1
    return count
