"""The pruning plan: what the rules ask for on a skeleton, where the blade goes, and what is unsure.

House frame: X along the row, Y depth with the cameras at smaller Y, Z up; metres.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from prunus.kernels.neighbours import nearest
from prunus.measure.cuts.doubts import confidence_of, doubts_of, traits_of
from prunus.measure.cuts.limbs import Limbs
from prunus.measure.cuts.reach import (
    AT_BLADE,
    SMEAR,
    Approach,
    approach,
    blade_normal,
    obstacles,
    samples,
)
from prunus.measure.cuts.rules import Demand, Left, verdicts
from prunus.measure.cuts.settings import CutRules, shipped_rules
from prunus.measure.refine import Refined
from prunus.model import Bools, Floats, Skeleton

Point = tuple[float, float, float]


@dataclass(frozen=True)
class Cut:
    """One cut; lengths in metres, volumes in cubic metres, unknown numbers NaN.

    `blade_normal` and `branch_direction` are unit vectors, both towards the wood that comes down;
    `stub` is the wood left between bark and blade, NaN where a leader is shortened; `along` is how
    far from where the branch starts. A person looks first where `reasons` has any.
    """

    id: str
    branch: str
    rule: str
    because: str
    point: Point
    blade_normal: Point
    branch_direction: Point
    approach: Approach | None
    diameter: float
    diameter_error: float
    stub: float
    along: float
    removed_length: float
    removed_volume: float
    confidence: float
    reasons: tuple[str, ...]

    @property
    def needs_review(self) -> bool:
        """Whether a person looks before it is made."""
        return bool(self.reasons)


@dataclass(frozen=True)
class Plan:
    """The cuts, by rule and branch; the branches that a rule looked at and left, and the rules."""

    cuts: tuple[Cut, ...]
    left: tuple[Left, ...]
    rules: CutRules


def plan_cuts(
    tree: Refined | Skeleton, scan: Floats | None = None, rules: CutRules | None = None
) -> Plan:
    """The pruning plan of a tree in the house frame.

    scan: all points (P, 3) around the tree, house frame, its own among them; without them no way
    to a cut is known, and every cut is reviewed. A plain skeleton has the radii it holds.
    """
    rules = rules or shipped_rules()
    tree = tree if isinstance(tree, Refined) else as_it_is(tree)
    limbs = Limbs.of(tree.skeleton)
    said = verdicts(limbs, rules)
    demands = [one for one in said if isinstance(one, Demand)]
    around = np.array([one.limb.at(one.along) for one in demands]).reshape(-1, 3)
    near = None if scan is None else obstacles(scan, around)
    cuts = tuple(_cut(limbs, tree, one, near, rules) for one in demands)
    return Plan(cuts, tuple(one for one in said if isinstance(one, Left)), rules)


def as_it_is(skeleton: Skeleton) -> Refined:
    """A skeleton that was not refined: its radii without doubt, all of it seen."""
    known = np.isfinite(skeleton.radius)
    error = np.where(known, 0.0, np.nan)
    return Refined(skeleton, error, np.zeros(len(skeleton), np.int64), np.ones(len(skeleton), bool))


def _cut(limbs: Limbs, tree: Refined, demand: Demand, near: Floats | None, rules: CutRules) -> Cut:
    limb = demand.limb
    point, heading = limb.at(demand.along), limb.heading(demand.along)
    traits = traits_of(limbs, tree, demand)
    confidence = confidence_of(demand, traits)
    reasons = doubts_of(demand, traits, confidence, rules.review)
    gone = limbs.beyond(limb, demand.along)
    way, normal = None, heading
    if near is None:
        reasons.append("no cloud: what stands in the way is not known")
    else:
        removed = _wood(tree.skeleton, gone, point)
        way = approach(point, heading, near, removed)
        normal = blade_normal(heading, np.array(way.direction))
        reasons += _crowded(limbs, demand, near, point, gone, rules)
        if way.half_angle < rules.review.free_angle:
            reasons.append(f"no way to it is free within {rules.review.free_angle:g} degrees")
    if demand.rule != "side_branches" and getattr(rules, demand.rule).always_review:
        reasons.append("it goes through a leader")
    length, volume = _removed(tree.skeleton, gone, demand)
    return Cut(
        f"{demand.rule}:{limb.name.replace(' ', '-')}", limb.name, demand.rule, demand.because,
        _point(point), _point(normal), _point(heading), way, traits.diameter, traits.doubt,
        demand.stub, demand.along, length, volume, confidence, tuple(reasons),
    )  # fmt: skip


def _crowded(
    limbs: Limbs, demand: Demand, near: Floats, point: Floats, gone: Bools, rules: CutRules
) -> list[str]:
    """Other wood, or what else stands there, too near to the blade."""
    reach = rules.review.other_wood
    skeleton = limbs.skeleton
    here = near[np.linalg.norm(near - point, axis=1) < reach + AT_BLADE]
    own = np.flatnonzero(gone | np.isin(limbs.owner, [demand.limb.number, demand.limb.parent]))
    own = own[own > 0]
    mine = samples(skeleton.xyz, skeleton.parent, own)
    fat = SMEAR + float(np.nan_to_num(skeleton.radius[own]).max(initial=0.01))
    strange = here[nearest(here, mine, fat) < 0] if len(here) else here
    away = np.linalg.norm(strange - point, axis=1)
    if not (away < reach).any():
        return []
    return [f"something else stands {1e3 * away.min():.0f} mm from the blade"]


def _wood(skeleton: Skeleton, gone: Bools, point: Floats) -> Floats:
    """Samples (S, 3) of the wood that comes down, the cut itself the first."""
    beyond = samples(skeleton.xyz, skeleton.parent, np.flatnonzero(gone))
    return np.concatenate([point[None], beyond])


def _removed(skeleton: Skeleton, gone: Bools, demand: Demand) -> tuple[float, float]:
    """Length and volume of what comes down; a radius that is unknown is taken from those known."""
    length = np.where(gone, skeleton.lengths, 0.0)
    first = np.flatnonzero(gone & np.isin(np.arange(len(gone)), demand.limb.rows))
    if len(first):
        start = demand.limb.along[np.searchsorted(demand.limb.rows, first[0])]
        length[first[0]] = start - demand.along
    else:
        return float(demand.limb.along[-1] - demand.along), math.nan
    known = gone & np.isfinite(skeleton.radius)
    if not known.any():
        return float(length.sum()), math.nan
    usual = float(np.median(skeleton.radius[known]))
    radius = np.where(np.isfinite(skeleton.radius), skeleton.radius, usual)
    return float(length.sum()), float((math.pi * radius**2 * length).sum())


def _point(values: Floats) -> Point:
    x, y, z = (float(value) for value in values)
    return x, y, z
