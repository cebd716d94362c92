"""The story on one page: a point cloud in, a labelled skeleton out."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from prunus.errors import PrunusError
from prunus.measure import remarks
from prunus.model import Floats, PointCloud, SeededGraph, Skeleton
from prunus.params import Parameters
from prunus.search import SearchResult, search, search_learned, shipped_score, skel_score
from prunus.stages.candidates import find_candidates
from prunus.stages.confidence import EdgeScorer, score_edges
from prunus.stages.networks import NetworkScorer
from prunus.stages.seeds import find_seeds
from prunus.stages.sidebranches import find_side_branches
from prunus.stages.stubs import drop_stubs
from prunus.stages.superpoints import find_superpoints

Seconds = dict[str, tuple[float, float]]
"""CPU and wall seconds of each stage."""


@dataclass(frozen=True, eq=False)
class Result:
    """The skeleton and the evidence: graph, score, history (I,) of best scores, timings, warnings.

    `in_house` is the skeleton in the house frame (Z up); `skeleton` in the frame of the input.
    """

    in_house: Skeleton
    graph: SeededGraph
    score: float
    history: Floats
    seconds: Seconds
    params: Parameters
    seed: int
    warnings: list[str]

    @cached_property
    def skeleton(self) -> Skeleton:
        """The skeleton in the frame of the input."""
        return self.in_house.moved(self.graph.superpoints.cloud.to_input)


def skeletonize(
    cloud: PointCloud | ArrayLike,
    base: ArrayLike | None = None,
    params: Parameters | None = None,
    seed: int = 0,
    scorer: EdgeScorer | None = None,
) -> Result:
    """Turn a cloud into a labelled skeleton.

    cloud: points (P, 3) in metres, Z up and X along the row; for another frame a `PointCloud`.
    base: a point (3,) where the trunk meets the ground, in the frame of the input; None finds it.
    Same input, parameters and seed give the same skeleton, bit for bit.
    Raises PrunusError where the cloud holds no tree that can be followed.
    """
    cloud = cloud if isinstance(cloud, PointCloud) else PointCloud.from_xyz(cloud)
    at = None if base is None else cloud.to_input.inverse().apply(_point(base))
    params = params or Parameters()
    rng = np.random.default_rng(seed)
    seconds: Seconds = {}

    with _timed(seconds, "sample"):
        points = params.input.points
        cloud = cloud.sample(None if points == "all" else points, rng)
    with _timed(seconds, "superpoints"):
        superpoints = find_superpoints(cloud, params.superpoints, rng)
    with _timed(seconds, "candidates"):
        candidates = find_candidates(superpoints)
    with _timed(seconds, "confidence"):
        scorer = scorer or NetworkScorer.shipped(params.confidence.edge_net)
        scored = score_edges(candidates, scorer, params.confidence)
    with _timed(seconds, "seeds"):
        seeded, warnings = find_seeds(scored, params, at)
    learned = params.search.score == "learned" and scored.category.size > 0
    if learned:
        with _timed(seconds, "search"):
            found = search_learned(seeded, shipped_score())
    else:
        found = _as_in_the_paper(seeded, params, rng, seconds)
    with _timed(seconds, "measures"):
        warnings += remarks(found.skeleton, seeded, for_tips=not learned)
    return Result(
        found.skeleton, seeded, found.score, found.history, seconds, params, seed, warnings
    )


def _as_in_the_paper(
    seeded: SeededGraph, params: Parameters, rng: np.random.Generator, seconds: Seconds
) -> SearchResult:
    """Trunk, supports and leaders first, side branches afterwards."""
    with _timed(seconds, "search"):
        found = search(seeded, params, rng, end_at_tips=True)
    with _timed(seconds, "stubs"):
        framework = drop_stubs(found.skeleton, params.leaders.min_length)
    with _timed(seconds, "side branches"):
        skeleton = find_side_branches(framework, seeded, params)
    return SearchResult(skeleton, skel_score(skeleton, params), found.history)


@contextmanager
def _timed(seconds: Seconds, stage: str) -> Iterator[None]:
    cpu, wall = time.process_time(), time.perf_counter()
    yield
    seconds[stage] = (time.process_time() - cpu, time.perf_counter() - wall)


def _point(base: ArrayLike) -> Floats:
    try:
        point = np.asarray(base, np.float64)
    except (TypeError, ValueError):
        point = np.zeros(0)
    if point.shape != (3,) or not np.isfinite(point).all():
        raise PrunusError(f"the base is {base!r}; expected three finite numbers x, y, z")
    return point
