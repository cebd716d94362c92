"""Whether what the chain found can be a tree: the one place that says so.

A skeleton of almost nothing, or of what is no wood, is a failure and not an answer.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from prunus.errors import NoTreeError
from prunus.measure.remarks import explained_points
from prunus.model import Label, Skeleton
from prunus.result import Result
from prunus.sensing.diagnosis import LINE_M, spread
from prunus.sensing.surroundings import Pieces
from prunus.sensing.trunks import find_trunks

LEAST_LENGTH_M = 0.30
"""A tree has so much wood."""
LEAST_EXPLAINED = 0.10
"""A skeleton passes so large a share of the points of its tree."""
MOST_EXPLAINED = 0.50
"""Where it passes less, a hedge or a heap of twigs is told by the next two."""
LEAST_TRUST = 0.60
"""So large a share of its edges is likely right; no tree of the 37 below had less than 0.71, save
one of which nothing was found."""
LEAST_LINEAR, USUAL_LINEAR = 0.25, 0.40
"""Of 37 clouds of trees, simulated, measured and real, none had less than 0.53 (see `Evidence`);
walls, balls, noise and leaves had 0.07 to 0.20."""
USUAL_RISE = 0.50
"""Leaders rise so much a metre of their length: 0.57 and more on the trees on which most was found,
0.20 and 0.44 on one that was laid on its side."""


@dataclass(frozen=True)
class Evidence:
    """What tells a tree from what is none.

    length: metres of skeleton; across: how far its points are off one line, metres; explained: the
    share of them within r_super of it; linear: how much the median superpoint looks like a piece
    of a branch, 0 to 1; rise: metres up a metre of leader. Of a scorer that tells categories:
    trunk, whether one is in view; trust, the share of the edges that are likely right, asked for
    where little is explained.
    """

    length: float
    across: float
    explained: float
    linear: float
    rise: float
    trunk: bool = True
    trust: float = 1.0

    @classmethod
    def of(cls, result: Result) -> Evidence:
        """The evidence in what the chain found."""
        skeleton, graph = result.in_house, result.graph
        length, explained = float(skeleton.lengths.sum()), explained_points(skeleton, graph)
        trunk, trust = True, 1.0
        if explained < MOST_EXPLAINED and graph.scored.category.size:
            trunk = bool(find_trunks(graph.scored))
            trust = 1.0 if result.trust is None else result.trust.tree
        across = float(spread(graph.superpoints.cloud.xyz)[1])
        linear = float(np.median(Pieces.of(graph.scored).linear))
        return cls(length, across, explained, linear, rise_of_leaders(skeleton), trunk, trust)

    def check(self) -> None:
        """Raise NoTreeError where it is no tree."""
        against = {
            ": no wood can be followed from its base": self.length == 0,
            f": {self.length:.2f} m of wood; expected at least {LEAST_LENGTH_M:g} m": (
                self.length < LEAST_LENGTH_M
            ),
            ", but a straight line": self.across < LINE_M,
            ", but a surface or a heap": self.linear < LEAST_LINEAR,
            f": its branches explain {self.explained:.0%} of the points": (
                self.explained < LEAST_EXPLAINED
            ),
            f", but a hedge or a heap of twigs: no trunk is in view, and {self._unexplained}": (
                not self.trunk
            ),
            f", but a hedge or a heap of twigs: {self.trust:.0%} of its edges are likely right and "
            f"{self._unexplained}": self.trust < LEAST_TRUST,
        }
        for words, is_so in against.items():
            if is_so:
                raise NoTreeError(f"no tree was found{words}")

    @property
    def _unexplained(self) -> str:
        return f"{1 - self.explained:.0%} of the points are not explained by any branch"

    def doubts(self) -> list[str]:
        """Why it may be none."""
        found = []
        if self.linear < USUAL_LINEAR:
            found.append("much of the cloud is not like branches, but like surfaces or heaps")
        if 0 < self.rise < USUAL_RISE:
            found.append(
                f"the leaders hardly rise ({self.rise:.1f} m a metre): is Z up (see --frame)?"
            )
        return found


def rise_of_leaders(skeleton: Skeleton) -> float:
    """How much the leaders of a skeleton go up or down a metre of their length; 0: it has none."""
    leaders = skeleton.edges_with(Label.LEADER)
    length = skeleton.lengths[leaders].sum()
    return float(np.abs(skeleton.edge_vectors[leaders, 2]).sum() / length) if length else 0.0
