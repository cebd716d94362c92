"""The pruning plan: what the rules ask for on a skeleton, where the blade goes, and what is unsure.

House frame: X along the row, Y depth with the cameras at smaller Y, Z up; metres.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from prunus.cuts.confidence import confidence_of
from prunus.cuts.doubts import doubts_around, doubts_of
from prunus.cuts.evidence import Evidence, evidence_of
from prunus.cuts.limbs import Limbs
from prunus.cuts.nearby import Nearby, nearby
from prunus.cuts.reach import Approach, approach, blade_normal, samples
from prunus.cuts.rules import Demand, Left, verdicts
from prunus.cuts.settings import CutRules, shipped_rules
from prunus.model import Bools, Floats, Skeleton
from prunus.refine.refined import Refined

Point = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class Cut:
    """One cut; lengths in metres, volumes in cubic metres, unknown numbers NaN.

    `blade_normal` and `branch_direction` are unit vectors, both towards the wood that comes down;
    `stub` is the wood left between bark and blade, NaN where a leader is shortened; `along` is how
    far from where the branch starts. A person looks first where `reasons` has any.
    """

    id: str
    branch: str
    branch_number: int
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
    evidence: Evidence

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
    tree: Refined | Skeleton,
    scan: Floats | None = None,
    rules: CutRules | None = None,
    names: list[str] | None = None,
    likely: Floats | None = None,
) -> Plan:
    """The pruning plan of a tree in the house frame.

    scan: all points (P, 3) around the tree, house frame, its own among them; without them no way
    to a cut is known, and every cut is reviewed. A plain skeleton has the radii it holds, and its
    lengths are taken as told. names: of the branches, as `branches` has them, where they
    are others than the tree's own. likely (M,): of a plain skeleton, how likely the branch of each
    row is right; where that is not known, no cut is sure.
    """
    rules = rules or shipped_rules()
    measured = isinstance(tree, Refined)
    tree = tree if isinstance(tree, Refined) else as_it_is(tree, likely)
    limbs = Limbs.of(tree.skeleton, names or tree.names, measured=measured)
    said = verdicts(limbs, rules)
    demands = [one for one in said if isinstance(one, Demand)]
    places = np.array([one.limb.at(one.along) for one in demands]).reshape(-1, 3)
    tips = np.array([one.limb.xyz[-1] for one in demands]).reshape(-1, 3)
    near = [None] * len(demands) if scan is None else nearby(scan, places, tips)
    cuts = [_cut(limbs, tree, *pair, rules) for pair in zip(demands, near, strict=True)]
    return Plan(tuple(cuts), tuple(one for one in said if isinstance(one, Left)), rules)


def as_it_is(skeleton: Skeleton, likely: Floats | None = None) -> Refined:
    """A skeleton that was not refined: its radii without doubt, all of it seen.

    likely (M,): how likely the branch of each row is right.
    """
    return Refined(
        skeleton=skeleton,
        radius_error=np.where(np.isfinite(skeleton.radius), 0.0, np.nan),
        unknown=np.zeros(len(skeleton), np.int64),
        seen=np.ones(len(skeleton), np.bool_),
        likely=np.full(len(skeleton), np.nan) if likely is None else likely,
    )


def _cut(
    limbs: Limbs, tree: Refined, demand: Demand, points: Nearby | None, rules: CutRules
) -> Cut:
    limb, along = demand.limb, demand.along
    point, heading = limb.at(along), limb.heading(along)
    gone = limbs.beyond(limb, along)
    evidence = evidence_of(limbs, tree, demand, points)
    confidence = confidence_of(limb.label, evidence)
    reasons = doubts_of(demand, evidence, confidence, rules)
    way, normal = None, heading
    if points is None:
        reasons.append("no cloud: what stands in the way is not known")
    else:
        beyond = samples(tree.skeleton.xyz, tree.skeleton.parent, np.flatnonzero(gone))
        way = approach(point, heading, points.cut, np.concatenate([point[None], beyond]))
        normal = blade_normal(heading, np.array(way.direction))
        reasons += doubts_around(limbs, demand, gone, points.cut, way, rules)
    length, volume = _removed(tree.skeleton, gone, demand)
    return Cut(
        id=f"{demand.rule}:{limb.name.replace(' ', '-')}",
        branch=limb.name,
        branch_number=limb.number,
        rule=demand.rule,
        because=demand.because,
        point=_point(point),
        blade_normal=_point(normal),
        branch_direction=_point(heading),
        approach=way,
        diameter=evidence.diameter,
        diameter_error=evidence.doubt,
        stub=demand.stub,
        along=along,
        removed_length=length,
        removed_volume=volume,
        confidence=confidence,
        reasons=tuple(reasons),
        evidence=evidence,
    )


def _removed(skeleton: Skeleton, gone: Bools, demand: Demand) -> tuple[float, float]:
    """Length and volume of what comes down; a radius that is unknown is taken from those known."""
    limb = demand.limb
    length = np.where(gone, skeleton.lengths, 0.0)
    beyond = np.flatnonzero(gone[limb.rows] & (limb.along > demand.along))
    if len(beyond) == 0:
        return float(limb.along[-1] - demand.along), math.nan
    length[limb.rows[beyond[0]]] = limb.along[beyond[0]] - demand.along
    radius, known = skeleton.radius, gone & np.isfinite(skeleton.radius)
    if not known.any():
        return float(length.sum()), math.nan
    radius = np.where(np.isfinite(radius), radius, np.median(radius[known]))
    return float(length.sum()), float((math.pi * radius**2 * length).sum())


def _point(values: Floats) -> Point:
    x, y, z = (float(value) for value in values)
    return x, y, z
