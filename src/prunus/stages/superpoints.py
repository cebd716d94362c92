"""Superpoint selection: cover the cloud by balls of r_super (sec. Superpoint selection)."""

from __future__ import annotations

import numpy as np

from prunus.errors import PrunusError
from prunus.kernels.neighbours import cover, within
from prunus.model import PointCloud, Superpoints
from prunus.params import Cover


def find_superpoints(cloud: PointCloud, params: Cover, rng: np.random.Generator) -> Superpoints:
    """The means of balls around randomly drawn uncovered points; balls of a few points are noise.

    Raises PrunusError where no ball holds `min_points`.
    """
    mean, size = cover(cloud.xyz, rng.permutation(len(cloud)), params.r_super)
    kept = mean[size >= params.min_points]
    if len(kept) == 0:
        raise PrunusError(
            f"no ball of {params.r_super:g} m holds {params.min_points} points (the fullest holds "
            f"{size.max()} of {len(cloud)}); expected a denser cloud, in metres"
        )
    start, members = within(cloud.xyz, kept, params.r_super)
    return Superpoints(cloud, kept, start, members, params.r_super)
