"""How sure it is that a cut is right.

Logistic models over the evidence, fitted to simulated trees by `python -m bench.fit_cuts`: the
probability that the rules ask for that cut on the true tree. For a side branch over seven things
known of it; for a leader, of which there are few to learn from, over its least sure edge alone.
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


@dataclass(frozen=True)
class Model:
    """Log odds that a cut is right: an offset, and for each feature a weight on what is unusual."""

    offset: float
    weight: dict[str, float]
    usual: dict[str, float]

    @classmethod
    def from_toml(cls, path: Path, part: str) -> Model:
        """The model in one part of a file: `side_branches` or `leaders`."""
        held = tomllib.loads(path.read_text(encoding="utf-8"))[part]
        return cls(held["offset"], held["weight"], held["usual"])

    def to_toml(self, part: str) -> str:
        """The part of a file that `from_toml` reads."""
        lines = [f"[{part}]", f"offset = {self.offset:.4f}"]
        for name in ("weight", "usual"):
            lines += ["", f"[{part}.{name}]"]
            lines += [f"{key} = {value:.4f}" for key, value in getattr(self, name).items()]
        return "\n".join(lines) + "\n"

    def __call__(self, evidence: Evidence) -> float:
        """The probability that a cut is right; unknown evidence is as usual."""
        known = {key: value for key, value in features(evidence).items() if math.isfinite(value)}
        found = {key: known[key] for key in self.weight if key in known}
        odds = sum(self.weight[key] * (value - self.usual[key]) for key, value in found.items())
        return 1 / (1 + math.exp(-self.offset - odds))


@cache
def shipped_model(part: str = "side_branches") -> Model:
    """The model that the package ships for cuts of `side_branches`, or through `leaders`."""
    return Model.from_toml(SHIPPED, part)


def confidence_of(label: Label, evidence: Evidence) -> float:
    """The confidence in a cut of a branch of that label; 0 where nothing is known of its edges."""
    if not math.isfinite(evidence.least):
        return 0.0
    return shipped_model("side_branches" if label == Label.SIDE_BRANCH else "leaders")(evidence)
