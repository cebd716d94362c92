"""The probabilities: logistic models fitted to simulated trees by `python -m bench.fit_trust`."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

from prunus.measure.odds import Odds
from prunus.model import Label
from prunus.reading import read_toml

SHIPPED = Path(__file__).parents[2] / "weights" / "trust.toml"
GROWN = SHIPPED.with_name("trust_grown.toml")
"""The models that the package ships: of trees that were searched for, and that grew on votes."""
WHOLE = ("meant", "wood", "form")
"""What is asked of a grown tree as a whole, see `GrownModel`."""


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


@dataclass(frozen=True)
class GrownModel:
    """The same of a grown tree, should it be the tree that is meant, and a tree.

    whole: that it is the tree that is `meant`, that it is a bare tree of `wood`, and that it is of
    the training `form` whose labels it has.
    """

    parts: Model
    whole: dict[str, Odds]

    @classmethod
    def from_toml(cls, path: Path) -> GrownModel:
        """The model in a file."""
        held = read_toml(path)
        return cls(Model.from_toml(path), {name: Odds.of(held[name]) for name in WHOLE})

    def to_toml(self) -> str:
        """The file that `from_toml` reads."""
        lines = [line for name in WHOLE for line in self.whole[name].lines(name)]
        return self.parts.to_toml() + "\n".join(lines) + "\n"


@cache
def grown_model() -> GrownModel:
    """The model of grown trees that the package ships."""
    return GrownModel.from_toml(GROWN)


@cache
def shipped_model() -> Model:
    """The model that the package ships."""
    return Model.from_toml(SHIPPED)
