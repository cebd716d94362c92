"""The probabilities: logistic models fitted to simulated trees by `python -m bench.fit_trust`."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from prunus.files.reading import read_toml
from prunus.model import Label
from prunus.trust.odds import Odds
from prunus.weights import WEIGHTS

SHIPPED = WEIGHTS / "trust.toml"
"""The model that the package ships."""
WHOLE = ("meant", "wood", "form")
"""What is asked of a tree as a whole, see `Model`."""


@dataclass(frozen=True)
class Parts:
    """That a branch of each label is right, and that an edge needs no correction."""

    branch: dict[Label, Odds]
    edge: Odds

    @classmethod
    def of(cls, held: dict[str, Any]) -> Parts:
        """As in a file."""
        return cls({label: Odds.of(held[label.word]) for label in Label}, Odds.of(held["edge"]))

    def lines(self) -> list[str]:
        """The lines of a file that `of` understands."""
        own = [line for label in Label for line in self.branch[label].lines(label.word)]
        return [*own, *self.edge.lines("edge")]


@dataclass(frozen=True)
class Model:
    """How likely parts are right, should it be the tree that is meant, and a tree.

    whole: that it is the tree that is `meant`, that it is a bare tree of `wood`, and that it is of
    the training `form` whose labels it has.
    """

    parts: Parts
    whole: dict[str, Odds]

    @classmethod
    def from_toml(cls, path: Path) -> Model:
        """The model in a file."""
        held = read_toml(path)
        return cls(Parts.of(held), {name: Odds.of(held[name]) for name in WHOLE})

    def to_toml(self) -> str:
        """The file that `from_toml` reads."""
        head = "# How far to trust branches and edges, made by `python -m bench.fit_trust`."
        whole = [line for name in WHOLE for line in self.whole[name].lines(name)]
        return "\n".join([head, *self.parts.lines(), *whole]) + "\n"


@cache
def shipped_model() -> Model:
    """The model that the package ships."""
    return Model.from_toml(SHIPPED)
