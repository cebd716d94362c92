"""Edge images: the points of a candidate edge, seen from the side (sec. Edge evaluation)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from prunus.kernels import frames
from prunus.model import CandidateGraph


def edge_images(candidates: CandidateGraph) -> NDArray[np.float32]:
    """Edge images (E, 16, 32), each divided by its fullest bin.

    Row = across the edge over [-r, r], column = along it over [-2 r, 2 r] with r = r_super, so
    bins are square, 12.5 mm at r = 0.10. The least significant direction of the points is dropped.
    """
    under = candidates.superpoints
    return frames.edge_images(
        under.cloud.xyz, under.xyz, under.start, under.members, candidates.edges, under.radius
    )
