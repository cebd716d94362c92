"""Superpoint selection: what stands for the cloud from here on (sec. Superpoint selection).

The paper covers the cloud by balls of r_super around points drawn at random, and names the main
remedy for what it misses: superpoints where branches are. So the cloud is drawn together onto the
axes of its branches first, and covered by rods along them, starting where branches end or meet.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from prunus.errors import PrunusError
from prunus.kernels.axes import contract, cover_along
from prunus.kernels.neighbours import cover, nearest, within
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

    Raises PrunusError where none holds `min_points`.
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
        raise PrunusError(
            f"no superpoint holds {params.min_points} points (the fullest holds "
            f"{size.max(initial=0)} of {len(cloud)} points over {_extent(cloud)}): too thin "
            "to tell wood from strays; expected an orchard tree scanned more densely, or more of "
            "its points (input.points), in metres (see the unit)"
        )
    start, members = within(cloud.xyz, kept, params.r_super)
    owner = nearest(axes.steps, kept, params.r_super)
    steps = np.bincount(owner[owner >= 0], minlength=len(kept))
    wood = np.asarray(PARKED * STEP * steps, np.float64)
    return Superpoints(cloud, kept, start, members, params.r_super, wood)


def _extent(cloud: PointCloud) -> str:
    return " x ".join(f"{size:.3g}" for size in np.ptp(cloud.xyz, axis=0)) + " m"


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
