"""How a tree is found, as a value: two parts, each of smaller parts that can be replaced.

    method = Method.default()
    without = replace(method, tree=replace(method.tree, choose=other))

is an ablation: the same method with one part another.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from prunus.errors import PrunusError
from prunus.model import Floats, PointCloud
from prunus.params import SCORES_NOTHING, MethodName, Parameters
from prunus.result import Found, Seconds

if TYPE_CHECKING:
    from prunus.paper.confidence import EdgeScorer


class SeesEvidence(Protocol):
    """What is to be known of a cloud before a tree is made of it, and where that stands.

    `growth.chain.Votes` (votes, threads), or `paper.chain.ScoredEdges` (superpoints, edges).
    """

    def __call__(
        self,
        cloud: PointCloud,
        at: Floats | None,
        params: Parameters,
        rng: np.random.Generator,
        seconds: Seconds,
        /,
    ) -> Any:
        """The evidence in a cloud whose tree stands at a base (3,), or at which one looks."""


class MakesTree(Protocol):
    """The labelled tree of that evidence: `growth.chain.Growth`, or `paper.chain.Search`."""

    def __call__(
        self, evidence: Any, params: Parameters, rng: np.random.Generator, seconds: Seconds, /
    ) -> Found:
        """The tree, and what is to be said of it."""


@dataclass(frozen=True, kw_only=True)
class Method:
    """What is seen of a cloud, and the tree that is made of it; `tree` takes what `evidence` gives.

    Both are frozen dataclasses of parts: functions and scorers.
    """

    evidence: SeesEvidence
    tree: MakesTree

    @classmethod
    def default(cls) -> Method:
        """Vote for the axis, then grow the tree (docs/growth.md)."""
        from prunus.growth.chain import Growth, Votes

        return cls(evidence=Votes(), tree=Growth())

    @classmethod
    def paper(cls) -> Method:
        """The paper's (docs/method.md)."""
        # Here, since it takes a compiler.
        from prunus.paper.chain import ScoredEdges, Search

        return cls(evidence=ScoredEdges(), tree=Search())

    @classmethod
    def of(cls, params: Parameters) -> Method:
        """The method that parameters name."""
        made = {"default": cls.default, "paper": cls.paper}
        name: MethodName = params.method
        return made[name]()

    def scored_by(self, scorer: EdgeScorer) -> Method:
        """The same with another scorer of edges; PrunusError where it scores none."""
        evidence: Any = self.evidence
        if "scorer" not in {part.name for part in fields(evidence)}:
            raise PrunusError(f"scorer: {SCORES_NOTHING}")
        return replace(self, evidence=replace(evidence, scorer=scorer))
