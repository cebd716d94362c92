"""Edge confidence through replaceable scorers (sec. Edge evaluation)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

import numpy as np

from prunus.errors import PrunusError
from prunus.model import CandidateGraph, Floats, Label, ScoredGraph
from prunus.model.arrays import Shape, frozen


class EdgeScorer(Protocol):
    """Whoever gives each candidate edge a confidence (E,) in [0, 1], finite."""

    @property
    def name(self) -> str:
        """What reports call it."""

    def __call__(self, candidates: CandidateGraph) -> Floats:
        """Conf(e) for every candidate edge."""


@runtime_checkable
class CategoryScorer(EdgeScorer, Protocol):
    """One who also tells what wood an edge is, by which the foot of the trunk is found."""

    def judge(self, candidates: CandidateGraph) -> tuple[Floats, Floats]:
        """Conf(e), and the probability (E, 5) of each category should the edge be valid.

        The categories are trunk, support, leader, side branch and other wood; rows sum to 1.
        """


def check_scorer(scorer: Any) -> None:
    """Raise PrunusError where somebody's own scorer is not what `EdgeScorer` asks for."""
    if isinstance(scorer, type):
        raise PrunusError(f"scorer: the class {scorer.__name__}; expected an object of it")
    missing = [name for name in ("name", "__call__") if not hasattr(scorer, name)]
    if missing:
        kind, lacks = type(scorer).__name__, ", no ".join(missing)
        raise PrunusError(f"scorer: {kind} has no {lacks}; expected an EdgeScorer")
    if not isinstance(scorer.name, str):
        raise PrunusError(f"scorer: its name is {scorer.name!r}; expected text")


def score_edges(candidates: CandidateGraph, scorer: EdgeScorer) -> ScoredGraph:
    """The candidates with the confidence that the scorer gives.

    Raises PrunusError naming the scorer where that is no confidence: the search trusts it.
    """
    size, name = len(candidates.edges), _who(scorer)
    if not isinstance(scorer, CategoryScorer):
        confidence = _shares(f"{name}: confidence", scorer(candidates), (size,))
        return ScoredGraph.of_confidence(candidates, confidence, scorer.name)
    told = scorer.judge(candidates)
    if not isinstance(told, tuple) or len(told) != 2:
        raise PrunusError(f"{name}: judge gave {type(told).__name__}; expected two arrays")
    confidence = _shares(f"{name}: confidence", told[0], (size,))
    category = _shares(f"{name}: category", told[1], (size, CATEGORIES))
    if not (np.abs(category.sum(axis=1) - 1) < SUM_ERROR).all():
        raise PrunusError(f"{name}: category: not all rows sum to 1; expected probabilities")
    return ScoredGraph(
        candidates=candidates, confidence=confidence, category=category, scorer=scorer.name
    )


CATEGORIES = len(Label) + 1
"""Trunk, support, leader, side branch, other wood."""
SUM_ERROR = 0.01
"""Probabilities in single, or half, precision sum to 1 but for so much."""


def _shares(name: str, values: Any, shape: Shape) -> Floats:
    """Numbers in [0, 1] of that shape: beyond, a way costs less than nothing, and has no end."""
    found: Floats = frozen(values, np.float64, shape, name)
    bad = ~((found >= 0) & (found <= 1))
    if bad.any():
        raise PrunusError(f"{name}: holds {found[bad][0]:.9g}; expected numbers from 0 to 1")
    return found


def _who(scorer: EdgeScorer) -> str:
    """A scorer by its file, where it has one."""
    return str(getattr(scorer, "path", f"scorer {scorer.name!r}"))


@dataclass(frozen=True)
class ConstantScorer:
    """Every edge the same: the scorer that does nothing."""

    value: float = 1.0
    name: str = "constant"

    def __call__(self, candidates: CandidateGraph) -> Floats:
        """The constant (E,)."""
        return np.full(len(candidates.edges), self.value)
