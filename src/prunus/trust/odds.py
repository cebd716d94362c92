"""Log odds as a weighted sum of what is known: small, and open to be read."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Odds:
    """An offset, and for each piece of evidence a weight on how far it is from what is usual."""

    offset: float
    weight: Mapping[str, float]
    usual: Mapping[str, float]

    @classmethod
    def of(cls, held: Mapping[str, Any]) -> Odds:
        """The odds of a table of a TOML file."""
        return cls(held["offset"], held["weight"], held["usual"])

    def lines(self, name: str) -> list[str]:
        """That table."""
        lines = ["", f"[{name}]", f"offset = {self.offset:.4f}"]
        for part in ("weight", "usual"):
            lines += ["", f"[{name}.{part}]"]
            lines += [f"{key} = {value:.4f}" for key, value in getattr(self, part).items()]
        return lines

    def __call__(self, evidence: Mapping[str, float]) -> float:
        """The probability; evidence that is NaN counts as usual."""
        known = {key: evidence[key] for key in self.weight if math.isfinite(evidence[key])}
        odds = sum(self.weight[key] * (value - self.usual[key]) for key, value in known.items())
        return 1 / (1 + math.exp(-self.offset - odds))
