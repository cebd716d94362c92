"""Superpoint selection: what stands for the cloud from here on (sec. Superpoint selection).

The paper covers the cloud by balls of r_super around points drawn at random, and names the main
remedy for what it misses: superpoints where branches are. So the cloud is drawn together onto the
axes of its branches first, and covered by rods along them, starting where branches end or meet.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from prunus.errors import NoTreeError, PrunusError
from prunus.geometry.near import nearest, within
from prunus.kernels.axes import contract, cover_along
from prunus.kernels.neighbours import cover
from prunus.model import Floats, Ints, PointCloud, Superpoints
from prunus.params import Cover
from prunus.stages.wires import on_wires

THIN = 0.015
"""The cloud is thinned to balls of this radius before it is drawn together, metres."""
GATHER = 0.03
"""Points within so many metres say where the axis is: about the radius of a smeared branch."""
ROUNDS = 3
"""Four or five were no better on forty trees."""
LONELY = 3.0
"""A point of the thinned cloud with less around it is noise; each counts the root of its points."""
STEP = 0.02
"""Wood is measured by balls of this radius along the drawn-together cloud, metres."""
ENDS = 2.0
"""How much it counts for the order that all else lies to one side, against being a line."""
PARKED = 1.337
"""A line covered at random by balls of radius 1 takes one every so often (Renyi's parking)."""


def find_superpoints(cloud: PointCloud, params: Cover, rng: np.random.Generator) -> Superpoints:
    """Superpoints on the axes of branches, or the means of random balls; few points are noise.

    Raises PrunusError where none holds `min_points`, or they would be too many to work with.
    """
    axes = _drawn_together(cloud, rng)
    if params.place == "axes":
        ends_first = np.argsort(axes.order, kind="stable")
        chosen, size = cover_along(
            axes.xyz, axes.along, axes.size, ends_first, params.along, params.across
        )
        xyz = axes.xyz[chosen]
    else:
        xyz, size = cover(cloud.xyz, rng.permutation(len(cloud)), params.r_super)
    kept = xyz[size >= params.min_points]
    if len(kept) == 0:
        raise NoTreeError(
            f"no wood was found: nowhere do {params.min_points} of the {len(cloud)} points drawn "
            "lie close together, as on a branch"
        )
    _check_crowd(cloud, kept, params)
    start, members = within(cloud.xyz, kept, params.r_super)
    owner = nearest(axes.steps, kept, params.r_super)
    steps = np.bincount(owner[owner >= 0], minlength=len(kept))
    wood = np.asarray(PARKED * STEP * steps, np.float64)
    return Superpoints(cloud, kept, start, members, params.r_super, wood)


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
                f"{count:.0e} {what}; expected at most {most:.0e}: a smaller r_super, or fewer "
                "superpoints (larger along and across)"
            )


LOOKED_AT = 200
"""So many superpoints say how much all of them have, about."""
MOST_POINTS, MOST_POINTS_OF_EDGES, MOST_PAIRS = 2e8, 1e9, 5e6
"""As much takes 2 GB, two minutes, and 3 GB; a raw scan takes a hundredth."""


@dataclass(frozen=True, eq=False)
class _Axes:
    """The drawn-together cloud (Q, 3) and the direction (Q, 3) of its branches.

    `order` (Q,) is least where branches end or meet; `size` (Q,) counts the points that each
    stands for; `steps` (S, 3) lie `STEP` apart.
    """

    xyz: Floats
    along: Floats
    order: Floats
    size: Ints
    steps: Floats


def _drawn_together(cloud: PointCloud, rng: np.random.Generator) -> _Axes:
    thinned, size = cover(cloud.xyz, rng.permutation(len(cloud)), THIN)
    xyz, along, line, aside, around = contract(thinned, np.sqrt(size), GATHER, ROUNDS)
    kept = around >= LONELY
    kept[kept] = ~on_wires(xyz[kept], along[kept], rng)
    xyz = xyz[kept]
    steps, _ = cover(xyz, rng.permutation(len(xyz)), STEP)
    return _Axes(xyz, along[kept], (line - ENDS * aside)[kept], size[kept], steps)
