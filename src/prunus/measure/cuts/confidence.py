"""How sure it is that a cut is right.

For a side branch a logistic model over its evidence, fitted to simulated trees by `python -m
bench.fit_cuts`: the probability that the rules ask for that cut on the true tree. For a leader the
confidence of its least sure edge.
"""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from prunus.measure.cuts.evidence import Evidence
from prunus.model import Label

SHIPPED = Path(__file__).parents[2] / "weights" / "cuts.toml"
"""The model that the package ships."""
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


@dataclass(frozen=True)
class Model:
    """Log odds that a cut is right: an offset, and for each feature a weight on what is unusual."""

    offset: float
    weight: dict[str, float]
    usual: dict[str, float]

    @classmethod
    def from_toml(cls, path: Path) -> Model:
        """The model in a file."""
        held = tomllib.loads(path.read_text(encoding="utf-8"))
        return cls(held["offset"], held["weight"], held["usual"])

    def to_toml(self) -> str:
        """The file that `from_toml` reads."""
        made = "# The confidence in a cut of a side branch, made by `python -m bench.fit_cuts`."
        lines = [made, f"offset = {self.offset:.4f}"]
        for name in ("weight", "usual"):
            lines += ["", f"[{name}]"]
            lines += [f"{key} = {value:.4f}" for key, value in getattr(self, name).items()]
        return "\n".join(lines) + "\n"

    def __call__(self, evidence: Evidence) -> float:
        """The probability that the cut of a side branch is right; unknown evidence are as usual."""
        found = {key: value for key, value in features(evidence).items() if math.isfinite(value)}
        odds = sum(self.weight[key] * (value - self.usual[key]) for key, value in found.items())
        return 1 / (1 + math.exp(-self.offset - odds))


@cache
def shipped_model() -> Model:
    """The model that the package ships."""
    return Model.from_toml(SHIPPED)


def confidence_of(label: Label, evidence: Evidence) -> float:
    """The confidence in a cut of a branch of that label; 0 where nothing is known of its edges."""
    if not math.isfinite(evidence.least):
        return 0.0
    return shipped_model()(evidence) if label == Label.SIDE_BRANCH else evidence.least
