"""One type per stage; each holds the one before it, and no field is ever optional."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from prunus.model.arrays import Bools, Floats, Ints, frozen
from prunus.model.cloud import PointCloud


@dataclass(frozen=True, eq=False)
class Superpoints:
    """Superpoints xyz (N, 3) and their points.

    Superpoint n has the points `members[start[n]:start[n + 1]]` of the cloud: those within
    `radius` (r_super, metres) of it. Balls overlap, so membership is many-to-many.
    """

    cloud: PointCloud
    xyz: Floats
    start: Ints
    members: Ints
    radius: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "xyz", frozen(self.xyz, np.float64, (None, 3)))
        object.__setattr__(self, "start", frozen(self.start, np.int64, (len(self.xyz) + 1,)))
        object.__setattr__(self, "members", frozen(self.members, np.int64, (None,)))

    def __len__(self) -> int:
        return len(self.xyz)

    @classmethod
    def of_nodes(cls, cloud: PointCloud, radius: float) -> Superpoints:
        """Every point its own superpoint: for graphs that come from elsewhere."""
        count = len(cloud)
        one_each = np.arange(count + 1), np.arange(count)
        return cls(cloud, cloud.xyz, *one_each, radius)

    def points_near(self, nodes: Ints) -> Bools:
        """Which points (P,) belong to any of these superpoints."""
        chosen = np.zeros(len(self), np.bool_)
        chosen[nodes] = True
        near = np.zeros(len(self.cloud), np.bool_)
        near[self.members[np.repeat(chosen, np.diff(self.start))]] = True
        return near

    @property
    def unused_points(self) -> int:
        """How many points belong to no superpoint."""
        return int((~self.points_near(np.arange(len(self)))).sum())


@dataclass(frozen=True, eq=False)
class CandidateGraph:
    """Candidate edges (E, 2): undirected pairs i < j of superpoints, sorted."""

    superpoints: Superpoints
    edges: Ints

    def __post_init__(self) -> None:
        object.__setattr__(self, "edges", frozen(self.edges, np.int64, (None, 2)))

    @property
    def xyz(self) -> Floats:
        """The superpoints (N, 3)."""
        return self.superpoints.xyz


@dataclass(frozen=True, eq=False, kw_only=True)
class ScoredGraph:
    """Confidence (E,) in [0, 1] for each candidate edge, and the name of who gave it.

    `category` (E, 5) is the probability of trunk, support, leader, side branch and other wood,
    should the edge be valid; (E, 0) where the scorer tells none.
    """

    candidates: CandidateGraph
    confidence: Floats
    category: Floats
    scorer: str

    def __post_init__(self) -> None:
        size = len(self.candidates.edges)
        object.__setattr__(self, "confidence", frozen(self.confidence, np.float64, (size,)))
        object.__setattr__(self, "category", frozen(self.category, np.float64, (size, None)))

    @classmethod
    def of_confidence(
        cls, candidates: CandidateGraph, confidence: Floats, scorer: str
    ) -> ScoredGraph:
        """The graph of a scorer that tells no categories."""
        return cls(
            candidates=candidates,
            confidence=confidence,
            category=np.zeros((len(candidates.edges), 0)),
            scorer=scorer,
        )

    @property
    def xyz(self) -> Floats:
        """The superpoints (N, 3)."""
        return self.candidates.xyz

    @property
    def edges(self) -> Ints:
        """The candidate edges (E, 2)."""
        return self.candidates.edges


@dataclass(frozen=True, eq=False)
class SeededGraph:
    """The base (a superpoint) and the tips (T,) (superpoints, sorted)."""

    scored: ScoredGraph
    base: int
    tips: Ints

    def __post_init__(self) -> None:
        object.__setattr__(self, "tips", frozen(self.tips, np.int64, (None,)))

    @property
    def superpoints(self) -> Superpoints:
        """The superpoints and the cloud below."""
        return self.scored.candidates.superpoints

    @property
    def xyz(self) -> Floats:
        """The superpoints (N, 3)."""
        return self.scored.xyz

    @property
    def edges(self) -> Ints:
        """The candidate edges (E, 2)."""
        return self.scored.edges

    @property
    def confidence(self) -> Floats:
        """The confidence (E,)."""
        return self.scored.confidence
