"""What speaks against a cut: the confidence that it is right, and why a person should look first.

The confidence of a cut through a side branch comes from a logistic model over what is known of the
branch, fitted to simulated trees by `python -m bench.fit_cuts`; it is the probability that the
rules ask for that cut on the true tree. For a cut through a leader it is that of the least sure
edge of the leader.
"""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from prunus.measure.cuts.limbs import Limb, Limbs, away_from
from prunus.measure.cuts.rules import Demand
from prunus.measure.cuts.settings import Review
from prunus.measure.refine import Refined
from prunus.model import Floats, Label

SHIPPED = Path(__file__).parents[2] / "weights" / "cuts.toml"
"""The model of the confidence that the package ships."""
TOUCH = 0.04
"""The tip of a branch so near to another branch may be its foot, metres."""
LEAST = 0.02
"""Confidences below are taken for it."""
UNSURE = 0.50
"""A diameter whose standard deviation is a larger share of it is doubtful."""


@dataclass(frozen=True)
class Traits:
    """What is known of a branch to be cut; NaN where nothing is.

    `sure`, `least`: mean and least confidence of its edges; `leader`, `path`: mean of its parent's,
    least from the base; `seen`: share of its length with points; `touch`: from its tip to the
    nearest other branch, metres; `thick`: its diameter over its parent's; `rise`: cosine of its
    chord with upright; `length`, `diameter`, `doubt` (its standard deviation), metres.
    """

    sure: float
    least: float
    leader: float
    path: float
    seen: float
    touch: float
    touched: str
    thick: float
    rise: float
    length: float
    diameter: float
    doubt: float


def traits_of(limbs: Limbs, tree: Refined, demand: Demand) -> Traits:
    """The traits of the branch that a demand cuts."""
    limb, skeleton = demand.limb, tree.skeleton
    sure = skeleton.confidence
    parent = limbs.parent_of(limb)
    touch, touched = _nearest_other(limbs, limb, limb.xyz[-1:])
    diameter = 2 * limb.value_at(demand.along, skeleton.radius)
    above = math.nan if parent is None else 2 * float(skeleton.radius[limb.rows[0]])
    chord = limb.xyz[-1] - limb.xyz[0]
    rows = limb.rows[1:]
    return Traits(
        sure=_mean(sure[rows], skeleton.lengths[rows]),
        least=_least(sure[rows]),
        leader=math.nan if parent is None else _mean(sure[parent.rows[1:]]),
        path=_least(sure[limbs.path_to(limb)]),
        seen=_mean(tree.seen[rows].astype(float), skeleton.lengths[rows]),
        touch=touch,
        touched=touched,
        thick=diameter / above,
        rise=float(chord[2] / max(float(np.linalg.norm(chord)), 1e-9)),
        length=limb.reach,
        diameter=diameter,
        doubt=2 * limb.value_at(demand.along, tree.radius_error),
    )


def _nearest_other(limbs: Limbs, limb: Limb, points: Floats) -> tuple[float, str]:
    """How near any other branch comes to points of a limb, and which; not its parent or its own."""
    best, name = math.inf, ""
    for other in limbs.all:
        if limb.number in (other.number, other.parent) or other.number == limb.parent:
            continue
        away = float(away_from(points, other.xyz).min())
        if away < best:
            best, name = away, other.name
    return best, name


@dataclass(frozen=True)
class Model:
    """The weight of each feature, and the offset, of the log odds that a cut is right."""

    weight: dict[str, float]
    offset: float

    def __call__(self, traits: Traits) -> float:
        """The probability that the cut of a side branch is right."""
        values = features(traits)
        odds = self.offset + sum(self.weight[name] * value for name, value in values.items())
        return 1 / (1 + math.exp(-odds))


def features(traits: Traits) -> dict[str, float]:
    """What the model sees of a branch; what is unknown counts as nothing."""
    found = {
        "sure": math.log(max(traits.sure, LEAST)),
        "least": math.log(max(traits.least, LEAST)),
        "leader": math.log(max(traits.leader, LEAST)),
        "path": math.log(max(traits.path, LEAST)),
        "seen": traits.seen,
        "touch": min(traits.touch, 0.10),
        "thick": min(traits.thick, 2.0),
        "diameter": min(traits.diameter, 0.04),
        "rise": traits.rise,
        "upright": max(traits.rise - 0.7, 0.0) * traits.length,
        "short": max(0.25 - traits.length, 0.0),
        "long": max(traits.length - 0.45, 0.0),
    }
    return {name: value if math.isfinite(value) else 0.0 for name, value in found.items()}


@cache
def shipped_model() -> Model:
    """The model that the package ships."""
    held = tomllib.loads(SHIPPED.read_text(encoding="utf-8"))
    return Model({str(k): float(v) for k, v in held["weight"].items()}, float(held["offset"]))


def confidence_of(demand: Demand, traits: Traits) -> float:
    """The confidence that a cut is right; 0 where nothing is known of its edges."""
    if demand.limb.label == Label.SIDE_BRANCH:
        return shipped_model()(traits) if math.isfinite(traits.sure) else 0.0
    return traits.least if math.isfinite(traits.least) else 0.0


def doubts_of(demand: Demand, traits: Traits, confidence: float, review: Review) -> list[str]:
    """Why a person should look at a cut before it is made, from the skeleton alone."""
    found = list(demand.doubts)
    if confidence < review.confidence:
        found.append(f"confidence {confidence:.2f}, under {review.confidence:g}")
    if traits.path < review.path:
        found.append(f"the way to it from the base has an edge of confidence {traits.path:.2f}")
    if not math.isfinite(traits.diameter):
        found.append("its diameter is not known")
    elif traits.doubt > UNSURE * traits.diameter:
        found.append(f"its diameter is known to {1e3 * traits.doubt:.0f} mm only")
    if traits.seen < review.seen:
        found.append(f"only {traits.seen:.0%} of it has points")
    if demand.limb.label == Label.SIDE_BRANCH:
        if traits.thick > review.thick:
            found.append(f"{traits.thick:.0%} as thick as its leader: it may be one")
        if traits.touch < TOUCH:
            found.append(f"its tip touches {traits.touched}: it may belong to it")
    return found


def _mean(values: Floats, weight: Floats | None = None) -> float:
    known = np.isfinite(values)
    if not known.any():
        return math.nan
    share = np.ones(len(values)) if weight is None else weight + 1e-9
    return float(np.average(values[known], weights=share[known]))


def _least(values: Floats) -> float:
    known = values[np.isfinite(values)]
    return float(known.min()) if len(known) else math.nan
