"""The parts of the paper's method: superpoints and scored edges as evidence, and the search."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from prunus.growth.chain import isolated_tree
from prunus.model import Floats, PointCloud, ScoredGraph, SeededGraph, Skeleton, Superpoints
from prunus.model.isolated import Isolated
from prunus.model.remarks import remarks
from prunus.paper.candidates import find_candidates
from prunus.paper.confidence import EdgeScorer, check_scorer, score_edges
from prunus.paper.found import SearchResult
from prunus.paper.networks import NetworkScorer
from prunus.paper.population import search
from prunus.paper.score import skel_score
from prunus.paper.seeds import find_seeds, out_of_weeds
from prunus.paper.sidebranches import find_side_branches
from prunus.paper.superpoints import find_superpoints
from prunus.paper.trunks import FOOT_REACH_M, find_foot, on_wood
from prunus.params import Cover, Parameters
from prunus.result import Found, Seconds, timed

Isolate = Callable[
    [PointCloud, Floats | None, Parameters, np.random.Generator, Seconds], Isolated | None
]


@dataclass(frozen=True, eq=False, kw_only=True)
class Seen:
    """A scan, its graph with base and tips, the foot (3,) where that was found, what was isolated.

    `warnings` and `notes` are what is to be said so far.
    """

    scan: PointCloud
    graph: SeededGraph
    foot: Floats | None
    isolated: Isolated | None
    warnings: list[str]
    notes: list[str]


@dataclass(frozen=True, kw_only=True)
class ScoredEdges:
    """Superpoints and edges as evidence; each part can be replaced by another of its kind.

    isolate: what of a scan is the tree, where that is asked for; superpoints: points to
    superpoints; scorer: who gives each candidate edge its confidence.
    """

    isolate: Isolate = isolated_tree
    superpoints: Callable[[PointCloud, Cover, np.random.Generator], Superpoints] = find_superpoints
    scorer: EdgeScorer = field(default_factory=NetworkScorer)

    def __call__(
        self,
        cloud: PointCloud,
        at: Floats | None,
        params: Parameters,
        rng: np.random.Generator,
        seconds: Seconds,
    ) -> Seen:
        """The graph of the tree of a cloud that stands at a base (3,); None: the base is found."""
        check_scorer(self.scorer)
        isolated = self.isolate(cloud, at, params, rng, seconds)
        tree = cloud if isolated is None else cloud.take(isolated.target)
        scored = self._scored(tree, params, rng, seconds)
        with timed(seconds, "seeds"):
            at, told = out_of_weeds(scored, at)
            foot = None if at is not None else _foot(tree, scored, isolated)
            graph, warnings = find_seeds(scored, params, foot if at is None else at)
        notes = [*told] if isolated is None else [isolated.told(), *told]
        if foot is not None:
            place = cloud.words_for(foot)
            notes.append(f"no base was given: the foot of the trunk was found at {place}")
        return Seen(
            scan=cloud, graph=graph, foot=foot, isolated=isolated, warnings=warnings, notes=notes
        )

    def _scored(
        self, cloud: PointCloud, params: Parameters, rng: np.random.Generator, seconds: Seconds
    ) -> ScoredGraph:
        """All candidate edges of points drawn from a cloud, with their confidence."""
        with timed(seconds, "sample"):
            drawn = cloud.sample(params.input.count, rng)
        with timed(seconds, "superpoints"):
            superpoints = self.superpoints(drawn, params.superpoints, rng)
        with timed(seconds, "candidates"):
            candidates = find_candidates(superpoints)
        with timed(seconds, "confidence"):
            return score_edges(candidates, self.scorer)


@dataclass(frozen=True, kw_only=True)
class Search:
    """The best skeleton of a graph; each part can be replaced by another of its kind.

    framework: trunk, supports and leaders; side_branches: what leaves the leaders.
    """

    framework: Callable[[SeededGraph, Parameters, np.random.Generator], SearchResult] = search
    side_branches: Callable[[Skeleton, SeededGraph, Parameters], Skeleton] = find_side_branches

    def __call__(
        self, seen: Seen, params: Parameters, rng: np.random.Generator, seconds: Seconds
    ) -> Found:
        """The best skeleton, standing at its foot."""
        best = self.best(seen.graph, params, rng, seconds)
        with timed(seconds, "measures"):
            warnings = [*seen.warnings, *remarks(best.skeleton, seen.graph, for_tips=True)]
        skeleton = best.skeleton if seen.foot is None else _standing_at(seen.foot, best.skeleton)
        return Found(
            skeleton=skeleton, graph=seen.graph, warnings=warnings, notes=seen.notes,
            isolated=seen.isolated, score=best.score, history=best.history,
        )  # fmt: skip

    def best(
        self, graph: SeededGraph, params: Parameters, rng: np.random.Generator, seconds: Seconds
    ) -> SearchResult:
        """The best skeleton: trunk, supports and leaders first, side branches afterwards."""
        with timed(seconds, "search"):
            found = self.framework(graph, params, rng)
        with timed(seconds, "side branches"):
            skeleton = self.side_branches(found.skeleton, graph, params)
        return SearchResult(skeleton, skel_score(skeleton, params), found.history)


def _foot(cloud: PointCloud, scored: ScoredGraph, isolated: Isolated | None) -> Floats | None:
    """Where the trunk stands (3,), on wood; None where no trunk is in view."""
    foot = find_foot(cloud, scored) if isolated is None else isolated.foot
    return on_wood(foot, scored)


def _standing_at(foot: Floats, skeleton: Skeleton) -> Skeleton:
    """The skeleton with its base at the foot of its trunk, where that is beside its lowest node."""
    if np.linalg.norm(skeleton.xyz[0] - foot) > FOOT_REACH_M:
        return skeleton
    return replace(skeleton, xyz=np.concatenate([foot[None], skeleton.xyz[1:]]))
