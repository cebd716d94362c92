"""The probabilities: logistic models fitted to simulated trees by `python -m bench.fit_trust`."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

from prunus.measure.odds import Odds
from prunus.model import Label
from prunus.reading import read_toml

SHIPPED = Path(__file__).parents[2] / "weights" / "trust.toml"
"""The models that the package ships."""


@dataclass(frozen=True)
class Model:
    """That a branch of each label is right, and that an edge needs no correction."""

    branch: dict[Label, Odds]
    edge: Odds

    @classmethod
    def from_toml(cls, path: Path) -> Model:
        """The model in a file."""
        held = read_toml(path)
        return cls({label: Odds.of(held[label.word]) for label in Label}, Odds.of(held["edge"]))

    def to_toml(self) -> str:
        """The file that `from_toml` reads."""
        lines = ["# How far to trust branches and edges, made by `python -m bench.fit_trust`."]
        for label in Label:
            lines += self.branch[label].lines(label.word)
        return "\n".join([*lines, *self.edge.lines("edge")]) + "\n"


@cache
def shipped_model() -> Model:
    """The model that the package ships."""
    return Model.from_toml(SHIPPED)
