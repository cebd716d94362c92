"""How sure it is that a cut is right.

Logistic models over the evidence, fitted to simulated trees by `python -m bench.fit_cuts`: the
probability that the rules ask for that cut on the true tree. For a side branch over seven things
known of it; for a leader, of which there are few to learn from, over its least sure edge alone.
"""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path

from prunus.measure.cuts.evidence import Evidence
from prunus.measure.odds import Odds
from prunus.model import Label
from prunus.reading import read_toml

SHIPPED = Path(__file__).parents[2] / "weights" / "cuts.toml"
"""The models that the package ships."""
LEAST = 0.02
"""Confidences below are taken for it."""
FAR = 0.10
"""A tip farther from other branches is no better, metres."""


def features(evidence: Evidence) -> dict[str, float]:
    """What the model sees of a branch; NaN where it is unknown."""
    return {
        "least": math.log(max(evidence.least, LEAST)),
        "touch": min(evidence.touch, FAR),
        "bend": math.log(max(evidence.bend, 2.0)),
        "slant": math.log(max(evidence.slant, 0.5)),
        "spread": evidence.spread,
        "aside": math.log(max(evidence.aside, 0.002)),
        "behind": evidence.behind,
    }


@cache
def shipped_odds(part: str = "side_branches") -> Odds:
    """The model that the package ships for cuts of `side_branches`, or through `leaders`."""
    return Odds.of(read_toml(SHIPPED)[part])


def confidence_of(label: Label, evidence: Evidence) -> float:
    """The confidence in a cut of a branch of that label; 0 where nothing is known of its edges."""
    if not math.isfinite(evidence.least):
        return 0.0
    odds = shipped_odds("side_branches" if label == Label.SIDE_BRANCH else "leaders")
    return odds(features(evidence))
