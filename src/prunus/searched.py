"""The chains that search: the paper's, and the one with a learned score.

Points to superpoints, candidate edges and their confidence, tips, and the best skeleton.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from prunus.measure import remarks
from prunus.model import Floats, PointCloud, ScoredGraph, SeededGraph, Skeleton
from prunus.params import Parameters
from prunus.result import Result, Seconds, timed
from prunus.search import (
    SearchResult,
    goes_by_learned_score,
    search,
    search_learned,
    shipped_score,
    skel_score,
)
from prunus.sensing.isolate import Scene, isolate, judged_graph
from prunus.sensing.isolated import Isolated
from prunus.sensing.trunks import FOOT_REACH_M, find_foot, on_wood
from prunus.stages.candidates import find_candidates
from prunus.stages.confidence import EdgeScorer, check_scorer, hopeful, score_edges
from prunus.stages.networks import NetworkScorer
from prunus.stages.seeds import find_seeds, near_to, out_of_weeds
from prunus.stages.sidebranches import find_side_branches
from prunus.stages.stubs import drop_stubs
from prunus.stages.superpoints import find_superpoints


def search_tree(
    cloud: PointCloud,
    at: Floats | None,
    params: Parameters,
    seed: int,
    scorer: EdgeScorer | None,
) -> Result:
    """The tree of a cloud that stands at a base (3,); None: the base is found."""
    if scorer is None:
        scorer = NetworkScorer.shipped(params.confidence.edge_net)
    check_scorer(scorer)
    rng = np.random.default_rng(seed)
    seconds: Seconds = {}

    scan, doubts = cloud, list[str]()
    scored = _scored(cloud, scorer, params, rng, seconds)
    at, notes = out_of_weeds(scored, at)
    with timed(seconds, "isolate"):
        isolated = _isolated(cloud, scored, scorer, at, params, rng)
    if isolated is not None:
        cloud = cloud.take(isolated.target)
        scored = _scored(cloud, scorer, params, rng, seconds)
        notes.append(isolated.told())
        doubts += isolated.doubts()
    with timed(seconds, "seeds"):
        foot = None if at is not None else isolated.foot if isolated else find_foot(cloud, scored)
        foot = on_wood(foot, scored)
        hoped = hopeful(scored, scorer, params.confidence)
        at, told = out_of_weeds(hoped, at)
        notes += told
        seeded, warnings = find_seeds(hoped, params, foot if at is None else at)
    if foot is not None:
        place = cloud.words_for(foot)
        notes.append(f"no base was given: the foot of the trunk was found at {place}")
    learned = goes_by_learned_score(seeded, params)
    if params.method == "learned" and not learned:
        notes.append(f"{scorer.name} tells no categories: the paper's score was taken")
    found = best_skeleton(seeded, params, rng, seconds)
    with timed(seconds, "measures"):
        warnings += [*doubts, *remarks(found.skeleton, seeded, for_tips=not learned)]
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
        even = cloud.evened(rng) if params.input.draw == "space" else cloud
        drawn = even.sample(params.input.count, rng)
    with timed(seconds, "superpoints"):
        superpoints = find_superpoints(drawn, params.superpoints, rng)
    with timed(seconds, "candidates"):
        candidates = find_candidates(superpoints)
    with timed(seconds, "confidence"):
        return score_edges(candidates, scorer)


def _isolated(
    cloud: PointCloud,
    scored: ScoredGraph,
    scorer: EdgeScorer,
    at: Floats | None,
    params: Parameters,
    rng: np.random.Generator,
) -> Isolated | None:
    """The tree in a raw scan; None where the cloud is one tree already, or nothing is asked."""
    wanted = params.isolation.isolate
    if wanted == "never" or (at is not None and not near_to(scored, at)):
        return None
    known = scored if scorer.name == "cnn" else judged_graph(cloud, params, rng)
    if len(known.edges) == 0:
        return None
    drawn = Scene.of(known.candidates.superpoints.cloud, known)
    if wanted == "auto" and at is None and not drawn.trees:
        return None
    some = isolate(drawn, at)
    raw = some.removed >= params.isolation.raw_from and some.target.mean() >= LEAST_LEFT
    if not raw and wanted != "always":
        return None
    found = drawn.over(cloud).tree_at(some.base)
    return replace(found, rival=some.rival, torn=drawn.torn(some))


LEAST_LEFT = 0.02
"""Where less than this share of a scan would be left, it is not taken apart unasked."""


def _standing_at(foot: Floats, skeleton: Skeleton) -> Skeleton:
    """The skeleton with its base at the foot of its trunk, where that is beside its lowest node."""
    if np.linalg.norm(skeleton.xyz[0] - foot) > FOOT_REACH_M:
        return skeleton
    return replace(skeleton, xyz=np.concatenate([foot[None], skeleton.xyz[1:]]))


def best_skeleton(
    seeded: SeededGraph, params: Parameters, rng: np.random.Generator, seconds: Seconds
) -> SearchResult:
    """The best skeleton of a graph under the score that the parameters ask for."""
    if goes_by_learned_score(seeded, params):
        with timed(seconds, "search"):
            return search_learned(seeded, shipped_score())
    return _as_in_the_paper(seeded, params, rng, seconds)


def _as_in_the_paper(
    seeded: SeededGraph, params: Parameters, rng: np.random.Generator, seconds: Seconds
) -> SearchResult:
    """Trunk, supports and leaders first, side branches afterwards."""
    with timed(seconds, "search"):
        found = search(seeded, params, rng, end_at_tips=True)
    with timed(seconds, "stubs"):
        framework = drop_stubs(found.skeleton, params.leaders.min_length)
    with timed(seconds, "side branches"):
        skeleton = find_side_branches(framework, seeded, params)
    return SearchResult(skeleton, skel_score(skeleton, params), found.history)
