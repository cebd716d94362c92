"""Why a person should look at a cut before it is made."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from prunus.cuts.evidence import Evidence
from prunus.cuts.limbs import Limbs
from prunus.cuts.reach import SMEAR, Approach, samples
from prunus.cuts.rules import Demand
from prunus.cuts.settings import CutRules, Review
from prunus.geometry.near import nearest
from prunus.model import Bools, Floats, Label

TOUCH = 0.03
"""The tip of a branch so near to another branch may be its foot, metres."""
UNSURE = 0.50
"""A diameter whose standard deviation is a larger share of it is doubtful."""


def doubts_of(demand: Demand, evidence: Evidence, confidence: float, rules: CutRules) -> list[str]:
    """What is doubtful about a cut: the rule's own doubts, its branch, and the way to it."""
    found = [*demand.doubts]
    if demand.limb.label == Label.LEADER and getattr(rules, demand.rule).always_review:
        found.append("it goes through a leader")
    found += _unlikely(evidence, confidence, rules.review)
    found += _hardly_seen(evidence, rules.review)
    if demand.limb.label == Label.SIDE_BRANCH:
        found += _something_else(evidence, rules.review)
    return found


def _unlikely(evidence: Evidence, confidence: float, review: Review) -> Iterator[str]:
    """Where the branch, or one on the way to it, may be none."""
    if not math.isfinite(evidence.likely):
        yield "how likely its branch is right is not known"
    elif confidence < review.confidence:
        yield f"confidence {_floor(confidence):.2f}, under {review.confidence:g}"
    if evidence.way < review.way:
        yield f"a branch on the way to it is likely wrong ({evidence.way:.0%} sure)"


def _hardly_seen(evidence: Evidence, review: Review) -> Iterator[str]:
    """Where the scan tells little of it."""
    if not math.isfinite(evidence.diameter):
        yield "its diameter is not known"
    elif evidence.doubt > UNSURE * evidence.diameter:
        yield f"its diameter is known to {1e3 * evidence.doubt:.0f} mm only"
    if evidence.seen < review.seen:
        yield f"only {evidence.seen:.0%} of it has points"


def _something_else(evidence: Evidence, review: Review) -> Iterator[str]:
    """Where a side branch may be something else, or another's."""
    doubts = (
        (evidence.thick > review.thick,
         f"{evidence.thick:.0%} as thick as its leader: it may be one"),
        (evidence.diameter > review.stout,
         f"{1e3 * evidence.diameter:.0f} mm thick: it may be a leader"),
        (evidence.upright < review.level, "its leader lies level there: it may be a support"),
        (evidence.behind > review.behind,
         "wood goes straight on behind its leader: it may be another's"),
        (evidence.past > review.past,
         "wood goes on past its tip that the skeleton does not have"),
        (evidence.touch < TOUCH, f"its tip touches {evidence.touched}: it may belong to it"),
    )  # fmt: skip
    return (text for doubtful, text in doubts if doubtful)


def _floor(share: float) -> float:
    """A share rounded down to hundredths: what is under a limit reads so."""
    return math.floor(100 * share) / 100


def doubts_around(
    limbs: Limbs, demand: Demand, gone: Bools, points: Floats, way: Approach, rules: CutRules
) -> list[str]:
    """What stands in the way: too near to the blade, or on every way to it."""
    found = []
    strange = _strange(limbs, demand, gone, points, rules.review.other_wood)
    if math.isfinite(strange):
        found.append(f"something else stands {1e3 * strange:.0f} mm from the blade")
    if way.half_angle < rules.review.free_angle:
        found.append(f"no way to it has {rules.review.free_angle:g} degrees free")
    return found


def _strange(limbs: Limbs, demand: Demand, gone: Bools, points: Floats, reach: float) -> float:
    """How near to the blade a point is that is none of the branch, its parent or what hangs on it.

    NaN where none is within reach.
    """
    skeleton = limbs.skeleton
    cut = demand.limb.at(demand.along)
    here = points[np.linalg.norm(points - cut, axis=1) < reach]
    own = gone | np.isin(limbs.owner, [demand.limb.number, demand.limb.parent])
    rows = np.flatnonzero(own)
    mine = samples(skeleton.xyz, skeleton.parent, rows[rows > 0])
    fat = SMEAR + float(np.nan_to_num(skeleton.radius[rows]).max(initial=0.01))
    strange = here[nearest(here, mine, fat) < 0] if len(here) else here
    return float(np.linalg.norm(strange - cut, axis=1).min()) if len(strange) else math.nan
