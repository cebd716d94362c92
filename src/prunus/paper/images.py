"""What the network is shown of a candidate edge (sec. Edge evaluation, Appendix A).

An image of its points, seen from the side, and where it lies in the tree. Nothing here changes
when the cloud is moved or turned half round about Z, or when the ends of an edge are swapped.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from prunus.model import CandidateGraph, Floats, Superpoints
from prunus.paper.kernels import frames

LOW = 5
"""The ground, or the foot of the tree, is this percentile of the superpoints' heights."""


def edge_images(candidates: CandidateGraph) -> NDArray[np.float32]:
    """Edge images (E, 16, 32), each divided by its fullest bin.

    Row = across the edge over [-r, r], column = along it over [-2 r, 2 r] with r = r_super, so
    bins are square, 12.5 mm at r = 0.10. The least significant direction of the points is dropped.
    """
    under = candidates.superpoints
    return frames.edge_images(
        under.cloud.xyz, under.xyz, under.start, under.members, candidates.edges, under.radius
    )


def description(candidates: CandidateGraph) -> NDArray[np.float32]:
    """Description vectors (E, 4): the midpoint relative to the tree, metres; sine of elevation.

    The midpoint is relative to the median along the row and in depth, without signs, and to the
    lower end in height.
    """
    place = _places(candidates.superpoints)
    ends = place[candidates.edges]
    vectors = np.diff(candidates.xyz[candidates.edges], axis=1)[:, 0]
    elevation = np.abs(vectors[:, 2]) / np.maximum(np.linalg.norm(vectors, axis=-1), 1e-9)
    return np.column_stack([np.abs(ends.mean(axis=1)), elevation]).astype(np.float32)


def _places(under: Superpoints) -> Floats:
    """Superpoints (N, 3) relative to the middle of the tree, and to its lower end in height."""
    middle = np.median(under.xyz, axis=0)
    middle[2] = np.percentile(under.xyz[:, 2], LOW)
    return np.asarray(under.xyz - middle)
