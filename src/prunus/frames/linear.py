"""How much a cloud looks like branches: the shape of what lies around its points."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from prunus.model import Floats, Superpoints
from prunus.model.arrays import cubes

REACH_M = 0.10
"""Around a point so much is looked at."""
PLACES, POINTS = 500, 60_000
"""So many places, evenly over the cloud, among so many points, are enough."""
FEWEST = 8
"""Fewer points have no shape."""
TINY = 1e-6
"""Square metres of spread that any superpoint has, so that one point is no line."""


def linear_of(xyz: Floats) -> float:
    """How much the surroundings of the median place of a cloud (P, 3) lie along one line, 0 to 1.

    (a - b) / a of the largest eigenvalues of their covariance (Demantké et al. 2011); 1 where no
    place has enough points.
    """
    xyz = xyz[:: max(1, len(xyz) // POINTS)]
    _, first = np.unique(cubes(xyz, REACH_M), return_index=True)
    some = first[:: max(1, len(first) // PLACES)]
    near = [
        rows for rows in cKDTree(xyz).query_ball_point(xyz[some], REACH_M) if len(rows) >= FEWEST
    ]
    found = [_along_a_line(xyz[rows]) for rows in near]
    return float(np.median(found)) if found else 1.0


def _along_a_line(xyz: Floats) -> float:
    spread = np.linalg.eigvalsh(np.cov(xyz.T))
    return float((spread[2] - spread[1]) / max(spread[2], 1e-12))


def linear_at(superpoints: Superpoints) -> float:
    """How much the points of the median superpoint lie along one line through it, 0 to 1."""
    count = np.diff(superpoints.start)
    owner = np.repeat(np.arange(len(superpoints)), count)
    away = superpoints.cloud.xyz[superpoints.members] - superpoints.xyz[owner]
    products = (away[:, :, None] * away[:, None, :]).reshape(-1, 9)
    sums = [np.bincount(owner, column, len(superpoints)) for column in products.T]
    moments = np.column_stack(sums) / np.maximum(count, 1)[:, None]
    spread = np.linalg.eigvalsh(moments.reshape(-1, 3, 3) + TINY * np.eye(3))
    return float(np.median((spread[:, 2] - spread[:, 1]) / spread[:, 2]))
