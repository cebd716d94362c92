"""Superpoint selection: what stands for the cloud from here on (sec. Superpoint selection).

The cloud is covered by balls of r_super around points drawn at random.
"""

from __future__ import annotations

import numpy as np

from prunus.errors import NoTreeError, PrunusError
from prunus.geometry.near import within
from prunus.geometry.neighbours import cover
from prunus.model import Floats, PointCloud, Superpoints
from prunus.params import Cover


def find_superpoints(cloud: PointCloud, params: Cover, rng: np.random.Generator) -> Superpoints:
    """The means of random balls that cover the cloud; few points are noise.

    Raises PrunusError where none holds `min_points`, or they would be too many to work with.
    """
    xyz, size = cover(cloud.xyz, rng.permutation(len(cloud)), params.r_super)
    kept = xyz[size >= params.min_points]
    if len(kept) == 0:
        raise NoTreeError(
            f"no wood was found: nowhere do {params.min_points} of the {len(cloud)} points drawn "
            "lie close together, as on a branch"
        )
    _check_crowd(cloud, kept, params)
    start, members = within(cloud.xyz, kept, params.r_super)
    return Superpoints(cloud, kept, start, members, params.r_super)


def _check_crowd(cloud: PointCloud, superpoints: Floats, params: Cover) -> None:
    """Raise PrunusError where the superpoints (N, 3) would take all memory, or hours."""
    some = superpoints[:: max(1, len(superpoints) // LOOKED_AT)]
    points = len(within(cloud.xyz, some, params.r_super)[1]) / len(some)
    met = len(within(superpoints, some, 2 * params.r_super)[1]) / len(some)
    edges = len(superpoints) * met / 2
    for what, count, most in (
        ("points of superpoints", len(superpoints) * points, MOST_POINTS),
        ("points of edges", edges * points, MOST_POINTS_OF_EDGES),
        ("pairs of edges", edges * met, MOST_PAIRS),
    ):
        if count > most:
            raise PrunusError(
                f"{len(superpoints)} superpoints of r_super {params.r_super:g} m make about "
                f"{count:.0e} {what}; expected at most {most:.0e}: a smaller r_super"
            )


LOOKED_AT = 200
"""So many superpoints say how much all of them have, about."""
MOST_POINTS, MOST_POINTS_OF_EDGES, MOST_PAIRS = 2e8, 1e9, 5e6
"""As much takes 2 GB, two minutes, and 3 GB; a raw scan takes a hundredth."""
