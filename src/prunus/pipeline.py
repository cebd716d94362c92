"""The story on one page: a point cloud in, a labelled skeleton out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from prunus.errors import NoTreeError, PrunusError
from prunus.measure import remarks
from prunus.model import Floats, PointCloud, ScoredGraph, SeededGraph, Skeleton
from prunus.model.arrays import frozen
from prunus.params import Parameters, checked_params, checked_seed
from prunus.plausible import Evidence
from prunus.result import Result, Seconds, timed
from prunus.search import (
    SearchResult,
    goes_by_learned_score,
    search,
    search_learned,
    shipped_score,
    skel_score,
)
from prunus.sensing.diagnosis import explaining
from prunus.sensing.isolate import Isolated, Scene, isolate, judged_graph
from prunus.sensing.trunks import FOOT_REACH_M, find_foot, on_wood
from prunus.stages.candidates import find_candidates
from prunus.stages.confidence import EdgeScorer, check_scorer, hopeful, score_edges
from prunus.stages.networks import NetworkScorer
from prunus.stages.seeds import find_seeds, near_to, out_of_weeds
from prunus.stages.sidebranches import find_side_branches
from prunus.stages.stubs import drop_stubs
from prunus.stages.superpoints import find_superpoints


def skeletonize(
    cloud: PointCloud | ArrayLike,
    base: ArrayLike | None = None,
    params: Parameters | Mapping[str, Any] | None = None,
    seed: int = 0,
    scorer: EdgeScorer | None = None,
) -> Result:
    """Turn a cloud into a labelled skeleton.

    cloud: points (P, 3) in metres, Z up and X along the row; for another frame a `PointCloud`.
    base: a point (3,) where the trunk meets the ground, in the frame of the input; None finds it.
    params: also as nested dicts. scorer: your own, which has to keep to its range.
    Same input, parameters and seed give the same skeleton, bit for bit.
    Raises PrunusError naming the argument that is wrong; NoTreeError where the cloud holds no tree
    that can be followed, with the reason and what to try.
    """
    cloud = cloud if isinstance(cloud, PointCloud) else PointCloud.from_xyz(cloud)
    with explaining(cloud):
        return _judged(follow(cloud, base, params, seed, scorer))


def follow(
    cloud: PointCloud,
    base: ArrayLike | None = None,
    params: Parameters | Mapping[str, Any] | None = None,
    seed: int = 0,
    scorer: EdgeScorer | None = None,
) -> Result:
    """What `skeletonize` finds, tree or not: for experiments, which count the failures too."""
    at = None if base is None else cloud.to_input.inverse().apply(_point(base))
    params, seed = checked_params(params), checked_seed(seed)
    if params.search.score == "growth":
        return _grown(cloud, at, params, seed)
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
    if params.search.score == "learned" and not learned:
        notes.append(f"{scorer.name} tells no categories: the paper's score was taken")
    found = best_skeleton(seeded, params, rng, seconds)
    with timed(seconds, "measures"):
        warnings += [*doubts, *remarks(found.skeleton, seeded, for_tips=not learned)]
    skeleton = found.skeleton if foot is None else _standing_at(foot, found.skeleton)
    return Result(
        skeleton, seeded, found.score, found.history, seconds, params, seed, warnings,
        notes, scan, isolated,
    )  # fmt: skip


def _grown(cloud: PointCloud, at: Floats | None, params: Parameters, seed: int) -> Result:
    """The tree that grows on the votes of the point field."""
    # Here, since scipy's graphs take as long to load as a small tree to grow, and no other chain
    # needs them.
    from prunus.grown import grow_tree

    seconds: Seconds = {}
    grown = grow_tree(cloud, at, params, np.random.default_rng(seed), seconds)
    with timed(seconds, "measures"):
        warnings = remarks(grown.skeleton, grown.graph, for_tips=False)
    return Result(
        grown.skeleton, grown.graph, 0.0, np.zeros(0), seconds, params, seed, warnings,
        grown.notes, cloud, grown.isolated, grown.told,
    )  # fmt: skip


def _judged(result: Result) -> Result:
    """The result with what is doubtful about it; NoTreeError where it is no tree."""
    evidence = Evidence.of(result)
    try:
        evidence.check()
    except NoTreeError as error:
        if result.isolated is None:
            raise
        raise NoTreeError(
            f"{error}; {result.isolated.removed:.0%} of the scan was left out as no part of this "
            "tree (--no-isolate keeps it, --base says where the tree stands)"
        ) from error
    return replace(result, warnings=[*evidence.doubts(), *result.warnings])


def _scored(
    cloud: PointCloud,
    scorer: EdgeScorer,
    params: Parameters,
    rng: np.random.Generator,
    seconds: Seconds,
) -> ScoredGraph:
    """All candidate edges of points drawn from a cloud, with their confidence."""
    with timed(seconds, "sample"):
        points = params.input.points
        even = cloud.evened(rng) if params.input.draw == "space" else cloud
        drawn = even.sample(None if points == "all" else points, rng)
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


def _point(base: ArrayLike) -> Floats:
    point = frozen(base, np.float64, (3,), "base")
    if not np.isfinite(point).all():
        raise PrunusError(f"base: {point}; expected three finite numbers x, y, z")
    return point
