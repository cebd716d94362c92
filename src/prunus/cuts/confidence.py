"""How sure it is that a cut is right.

Logistic models over the evidence, fitted to simulated trees by `python -m bench.fit_cuts`: the
probability that the rules ask for that cut on the true tree. For a side branch over seven things
known of it; for a leader, of which there are few to learn from, over its being right alone.
"""

from __future__ import annotations

import math
from functools import cache

from prunus.cuts.evidence import Evidence
from prunus.files.reading import read_toml
from prunus.model import Label
from prunus.trust.odds import Odds
from prunus.weights import WEIGHTS

SHIPPED = WEIGHTS / "cuts.toml"
"""The models that the package ships."""
LEAST = 0.02
"""No branch is taken for less likely, nor for surer than one less this."""


def features(evidence: Evidence) -> dict[str, float]:
    """What the model sees of a branch; NaN where it is unknown."""
    return {
        "likely": _odds(evidence.likely),
        "way": _odds(evidence.way),
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
    """The confidence in a cut of a branch of that label; 0 where nobody knows how sure it is."""
    if not math.isfinite(evidence.likely):
        return 0.0
    odds = shipped_odds("side_branches" if label == Label.SIDE_BRANCH else "leaders")
    return odds(features(evidence))


def _odds(likely: float) -> float:
    """The log odds of a probability; NaN where it is not known."""
    sure = min(max(likely, LEAST), 1 - LEAST)
    return math.log(sure / (1 - sure)) if math.isfinite(likely) else math.nan
