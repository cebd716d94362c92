"""Graphs of a wanted size, cut out of simulated orchard rows."""

from __future__ import annotations

from functools import cache

import numpy as np

from prunus.model import (
    CandidateGraph,
    Floats,
    PointCloud,
    ScoredGraph,
    SeededGraph,
    Skeleton,
    Superpoints,
)
from prunus.params import Parameters
from prunus.simulate import Faults, grow_tree, scan_tree
from prunus.stages.candidates import find_candidates
from prunus.stages.confidence import HandmadeScorer, score_edges
from prunus.stages.seeds import find_seeds
from prunus.stages.superpoints import find_superpoints

PARAMS = Parameters()
SPACING = 1.5
"""Distance of the trees of a row, metres: near enough to touch."""


@cache
def tree_scan(seed: int, points: int = 50_000) -> tuple[Skeleton, Floats]:
    """A true tree and the points of its scan, in one frame."""
    rng = np.random.default_rng(seed)
    truth = grow_tree(rng)
    cloud = scan_tree(truth, rng, Faults(points=points))
    return truth, cloud.to_input.apply(cloud.xyz)


@cache
def graph_of(seed: int) -> SeededGraph:
    """The graph of one simulated tree, as the chain makes it."""
    truth, points = tree_scan(seed)
    rng = np.random.default_rng(seed)
    scored = _scored(points, rng)
    cloud = scored.candidates.superpoints.cloud
    return find_seeds(scored, PARAMS, cloud.to_input.inverse().apply(truth.xyz[0]))[0]


@cache
def row_graph(nodes: int, edges_per_node: float = 2.0, seed: int = 100) -> SeededGraph:
    """A graph of exactly so many superpoints and edges: the left end of a row of trees.

    The most confident candidates are kept. Tips are found as in the chain.
    """
    trees = 1 + nodes // 150
    scans = [tree_scan(seed + k, 30_000)[1] + [k * SPACING, 0, 0] for k in range(trees)]
    scored = _scored(np.concatenate(scans), np.random.default_rng(seed))
    under = scored.candidates.superpoints
    kept = np.sort(np.argsort(under.xyz[:, 0], kind="stable")[:nodes])
    assert len(kept) == nodes, "the row is too short for that many superpoints"
    row_of = np.full(len(under), -1)
    row_of[kept] = np.arange(nodes)
    inside = np.flatnonzero((row_of[scored.edges] >= 0).all(axis=1))
    best = inside[np.argsort(-scored.confidence[inside], kind="stable")]
    chosen = np.sort(best[: round(edges_per_node * nodes)])
    cloud = PointCloud(under.xyz[kept], under.cloud.to_input)
    own = Superpoints(cloud, cloud.xyz, np.arange(nodes + 1), np.arange(nodes), under.radius)
    graph = ScoredGraph(
        CandidateGraph(own, row_of[scored.edges[chosen]]), scored.confidence[chosen], "handmade"
    )
    return find_seeds(graph, PARAMS)[0]


def _scored(points: Floats, rng: np.random.Generator) -> ScoredGraph:
    superpoints = find_superpoints(PointCloud.from_xyz(points), PARAMS.superpoints, rng)
    return score_edges(find_candidates(superpoints), HandmadeScorer(), PARAMS.confidence)
