"""What is known of a branch that is to be cut: of its rightness, its shape, and points near it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from prunus.cuts.limbs import Limb, Limbs
from prunus.cuts.nearby import Nearby, told_by_points
from prunus.cuts.rules import Demand
from prunus.geometry.near import away_from
from prunus.geometry.vectors import unit
from prunus.model import Floats
from prunus.refine.radii import known_radius
from prunus.refine.refined import Refined

BESIDE_M = 0.12
"""How steeply a limb rises is read off the stretch of it within this distance."""
TINY = 1e-9


@dataclass(frozen=True, kw_only=True)
class Evidence:
    """What is known of a branch to be cut; NaN where nothing is.

    `likely`, how likely it is right, `way`, the least of those from the base to it
    (`trust`), and `seen`, the share of its length with points. From its shape: `length` and
    `diameter` at the cut with its standard deviation `doubt`, metres; `thick`, that over its
    parent's; `bend` at its foot, degrees; `slant`, how far it runs in its parent's bark over the
    parent's radius; `touch`, metres from its tip to the nearest branch that is not its own,
    `touched`; `upright`, how steeply its parent rises where it leaves, degrees.

    From the points: `spread`, their mean distance from its axis at the cut, metres; `aside`, how
    far from the cut the line through them passes; `behind`, how much of the straight way back
    beyond the parent has wood, as where a branch of another leader passes by; `past`, how many
    cubes of 1 cm hold wood ahead of its tip that the skeleton does not have.
    """

    likely: float
    way: float
    seen: float
    length: float
    diameter: float
    doubt: float
    thick: float
    bend: float
    slant: float
    touch: float
    touched: str
    upright: float
    spread: float = math.nan
    aside: float = math.nan
    behind: float = math.nan
    past: float = math.nan


def evidence_of(limbs: Limbs, tree: Refined, demand: Demand, points: Nearby | None) -> Evidence:
    """The evidence of the branch that a demand cuts, with the points of the scan, if any."""
    limb, skeleton = demand.limb, tree.skeleton
    rows, parent = limb.rows[1:], limbs.parent_of(limb)
    radius = _parent_radius(limbs, limb)
    diameter = 2 * limb.value_at(demand.along, skeleton.radius)
    touch, touched = _nearest_other(limbs, limb)
    told = {} if points is None else told_by_points(limbs, limb, radius, demand.along, points)
    return Evidence(
        likely=_least(tree.likely[rows]),
        way=_least(tree.likely[limbs.path_to(limb)]),
        seen=tree.seen_share(rows),
        length=limb.reach,
        diameter=diameter,
        doubt=2 * limb.value_at(demand.along, tree.radius_error),
        thick=diameter / (2 * radius),
        bend=limb.bend,
        slant=limb.bark / radius,
        touch=touch,
        touched=touched,
        upright=math.nan if parent is None else _rise(parent, limb.xyz[0]),
        **told,
    )


def _parent_radius(limbs: Limbs, limb: Limb) -> float:
    parent = limbs.parent_of(limb)
    label = limb.label if parent is None else parent.label
    return known_radius(limbs.skeleton, int(limb.rows[0]), label)


def _rise(parent: Limb, foot: Floats) -> float:
    """How steeply a limb rises about a place on it, degrees."""
    stretch = parent.xyz[np.linalg.norm(parent.xyz - foot, axis=1) <= BESIDE_M]
    if len(stretch) < 2:
        stretch = parent.xyz
    return math.degrees(math.asin(abs(unit(stretch[-1] - stretch[0])[2])))


def _nearest_other(limbs: Limbs, limb: Limb) -> tuple[float, str]:
    """How near another branch comes to the tip of a limb, and which; not its parent or its own."""
    best, name = math.inf, ""
    for other in limbs.all:
        if limb.number in (other.number, other.parent) or other.number == limb.parent:
            continue
        away = float(away_from(limb.xyz[-1:], other.xyz)[0])
        if away < best:
            best, name = away, other.name
    return best, name


def _least(values: Floats) -> float:
    known = values[np.isfinite(values)]
    return float(known.min()) if len(known) else math.nan
