"""Graphs of a wanted size, cut out of simulated orchard rows."""

from __future__ import annotations

from functools import cache

import numpy as np

from prunus.lab.simulate import simulate_scan
from prunus.model import (
    CandidateGraph,
    Floats,
    Ints,
    PointCloud,
    ScoredGraph,
    SeededGraph,
    Skeleton,
    Superpoints,
)
from prunus.paper.candidates import find_candidates
from prunus.paper.confidence import score_edges
from prunus.paper.kernels.forest import spanning_forest
from prunus.paper.networks import NetworkScorer
from prunus.paper.seeds import find_seeds
from prunus.paper.superpoints import find_superpoints
from prunus.params import Parameters

PARAMS = Parameters.paper()
SPACING = 1.2
"""Distance of the trees of a row, metres: near enough to grow into each other."""


@cache
def tree_scan(seed: int, points: int = 50_000) -> tuple[Skeleton, Floats]:
    """A true tree and its points in a field scan, in one frame.

    More points than the scan holds are repeated ones, a few millimetres off.
    """
    rng = np.random.default_rng(seed)
    scan = simulate_scan(seed)
    cloud = scan.target_cloud()
    if points > len(cloud):
        again = rng.integers(0, len(cloud), points - len(cloud))
        near = cloud.xyz[again] + rng.normal(0, 0.003, (len(again), 3))
        cloud = PointCloud(np.concatenate([cloud.xyz, near]), cloud.to_input)
    cloud = cloud.sample(points, rng)
    return scan.truth, cloud.to_input.apply(cloud.xyz)


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
    """A connected graph of exactly so many superpoints and edges: the near end of a row of trees.

    The superpoints are those nearest to the base of the first tree along candidate edges. Kept are
    a spanning forest of the most confident edges, and the most confident of the rest. Tips are
    found as in the chain.
    """
    trees = 2 + nodes // 150
    scans = [tree_scan(seed + k, 30_000) for k in range(trees)]
    points = [xyz + np.array([k * SPACING, 0, 0]) for k, (_, xyz) in enumerate(scans)]
    scored = _scored(np.concatenate(points), np.random.default_rng(seed))
    under = scored.candidates.superpoints
    foot = under.cloud.to_input.inverse().apply(scans[0][0].xyz[0])
    base = int(np.linalg.norm(under.xyz - foot, axis=1).argmin())
    kept = np.sort(_nearest(scored, base, nodes))
    row_of = np.full(len(under), -1)
    row_of[kept] = np.arange(nodes)
    inside = np.flatnonzero((row_of[scored.edges] >= 0).all(axis=1))
    best = inside[np.argsort(-scored.confidence[inside], kind="stable")]
    tree = spanning_forest(nodes, row_of[scored.edges[best]], np.arange(len(best)))
    ordered = np.concatenate([best[tree], best[~tree]])
    chosen = np.sort(ordered[: round(edges_per_node * nodes)])
    cloud = PointCloud(under.xyz[kept], under.cloud.to_input)
    own = Superpoints.of_nodes(cloud, under.radius)
    graph = ScoredGraph.of_confidence(
        CandidateGraph(own, row_of[scored.edges[chosen]]), scored.confidence[chosen], "cnn"
    )
    return find_seeds(graph, PARAMS, cloud.xyz[row_of[base]])[0]


def _nearest(scored: ScoredGraph, base: int, count: int) -> Ints:
    """The first nodes met from the base, edge by edge."""
    neighbours: dict[int, list[int]] = {}
    for i, j in scored.edges.tolist():
        neighbours.setdefault(i, []).append(j)
        neighbours.setdefault(j, []).append(i)
    met = {base: None}
    for node in (order := [base]):
        for other in neighbours.get(node, []):
            if other not in met:
                met[other] = None
                order.append(other)
    assert len(order) >= count, f"only {len(order)} superpoints hang together"
    return np.array(order[:count])


def _scored(points: Floats, rng: np.random.Generator) -> ScoredGraph:
    superpoints = find_superpoints(PointCloud.from_xyz(points), PARAMS.superpoints, rng)
    return score_edges(find_candidates(superpoints), NetworkScorer())
