"""The paper's chain, whole: a cloud in, the best skeleton of a graph of superpoints out.

Points to superpoints, candidate edges and their confidence, tips, the best skeleton, side branches.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from prunus.grown import isolated_tree
from prunus.measure import remarks
from prunus.model import Floats, PointCloud, ScoredGraph, SeededGraph, Skeleton
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
from prunus.params import Parameters
from prunus.result import Result, Seconds, timed
from prunus.sensing.isolated import Isolated


def search_tree(
    cloud: PointCloud,
    at: Floats | None,
    params: Parameters,
    seed: int,
    scorer: EdgeScorer | None,
) -> Result:
    """The tree of a cloud that stands at a base (3,); None: the base is found."""
    scorer = NetworkScorer() if scorer is None else scorer
    check_scorer(scorer)
    rng = np.random.default_rng(seed)
    seconds: Seconds = {}

    scan, isolated, notes = cloud, None, list[str]()
    if params.isolation.isolate != "never":
        isolated = isolated_tree(cloud, at, params, rng, seconds)
    if isolated is not None:
        cloud = cloud.take(isolated.target)
        notes.append(isolated.told())
    scored = _scored(cloud, scorer, params, rng, seconds)
    with timed(seconds, "seeds"):
        at, told = out_of_weeds(scored, at)
        foot = None if at is not None else _foot(cloud, scored, isolated)
        seeded, warnings = find_seeds(scored, params, foot if at is None else at)
    notes += told
    if foot is not None:
        place = cloud.words_for(foot)
        notes.append(f"no base was given: the foot of the trunk was found at {place}")
    found = best_skeleton(seeded, params, rng, seconds)
    with timed(seconds, "measures"):
        warnings += remarks(found.skeleton, seeded, for_tips=True)
    skeleton = found.skeleton if foot is None else _standing_at(foot, found.skeleton)
    return Result(
        skeleton, seeded, found.score, found.history, seconds, params, seed, warnings,
        notes, scan, isolated,
    )  # fmt: skip


def _scored(
    cloud: PointCloud,
    scorer: EdgeScorer,
    params: Parameters,
    rng: np.random.Generator,
    seconds: Seconds,
) -> ScoredGraph:
    """All candidate edges of points drawn from a cloud, with their confidence."""
    with timed(seconds, "sample"):
        drawn = cloud.sample(params.input.count, rng)
    with timed(seconds, "superpoints"):
        superpoints = find_superpoints(drawn, params.superpoints, rng)
    with timed(seconds, "candidates"):
        candidates = find_candidates(superpoints)
    with timed(seconds, "confidence"):
        return score_edges(candidates, scorer)


def _foot(cloud: PointCloud, scored: ScoredGraph, isolated: Isolated | None) -> Floats | None:
    """Where the trunk stands (3,), on wood; None where no trunk is in view."""
    foot = find_foot(cloud, scored) if isolated is None else isolated.foot
    return on_wood(foot, scored)


def _standing_at(foot: Floats, skeleton: Skeleton) -> Skeleton:
    """The skeleton with its base at the foot of its trunk, where that is beside its lowest node."""
    if np.linalg.norm(skeleton.xyz[0] - foot) > FOOT_REACH_M:
        return skeleton
    return replace(skeleton, xyz=np.concatenate([foot[None], skeleton.xyz[1:]]))


def best_skeleton(
    seeded: SeededGraph, params: Parameters, rng: np.random.Generator, seconds: Seconds
) -> SearchResult:
    """The best skeleton of a graph: trunk, supports and leaders first, side branches afterwards."""
    with timed(seconds, "search"):
        found = search(seeded, params, rng)
    with timed(seconds, "side branches"):
        skeleton = find_side_branches(found.skeleton, seeded, params)
    return SearchResult(skeleton, skel_score(skeleton, params), found.history)
