"""The door for those who bring their own graph and confidences."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from prunus.errors import PrunusError
from prunus.model import (
    CandidateGraph,
    Floats,
    Ints,
    Label,
    PointCloud,
    ScoredGraph,
    SeededGraph,
    Skeleton,
    Superpoints,
)
from prunus.params import Parameters
from prunus.search import search
from prunus.stages.seeds import find_tips


@dataclass(frozen=True, eq=False)
class GraphSkeleton:
    """What `search_graph` found.

    edges (m, 2) parent -> child in the caller's node indices; labels (m,) as words: trunk, support,
    leader; score: SkelScore; history (I,) the best score of each iteration of the population;
    skeleton: the same as a `Skeleton`.
    """

    edges: Ints
    labels: NDArray[np.str_]
    score: float
    history: Floats
    skeleton: Skeleton


def search_graph(
    nodes: ArrayLike,
    edges: ArrayLike,
    confidence: ArrayLike,
    base: int,
    *,
    tips: ArrayLike | None = None,
    params: Parameters | None = None,
    seed: int = 0,
) -> GraphSkeleton:
    """Search the best labelled tree in a graph (sec. Population-based search).

    nodes (N, 3) metres, Z up, X along the row; edges (E, 2) undirected pairs of nodes; confidence
    (E,) in [0, 1]; base and tips (T,) node indices, tips found as in the paper when None.
    Raises PrunusError naming the argument, what was found and what was expected.
    """
    params = params or Parameters()
    graph = _checked_graph(nodes, edges, confidence, params)
    count = len(graph.xyz)
    _check_indices("base", np.array([base]), count)
    if tips is None:
        ends = find_tips(graph.xyz, graph.edges, graph.confidence, params)
    else:
        _check_indices("tips", np.asarray(tips), count)
        ends = np.unique(np.asarray(tips, np.int64))
    ends = ends[ends != base]
    if len(ends) == 0:
        raise PrunusError("tips: none found; expected one or more nodes to grow to, not the base")
    seeded = SeededGraph(graph, int(base), ends)
    found = search(seeded, params, np.random.default_rng(seed))
    back = graph.candidates.superpoints.cloud.to_input
    pairs = found.skeleton.superpoint[found.skeleton.edges]
    words = np.array([Label(label).word for label in found.skeleton.label[1:]], dtype=np.str_)
    return GraphSkeleton(pairs, words, found.score, found.history, found.skeleton.moved(back))


def _checked_graph(
    nodes: ArrayLike, edges: ArrayLike, confidence: ArrayLike, params: Parameters
) -> ScoredGraph:
    cloud = PointCloud.from_xyz(nodes)
    count = len(cloud)
    pairs = np.asarray(edges)
    if pairs.size == 0:
        pairs = pairs.reshape(0, 2)
    if pairs.ndim != 2 or pairs.shape[1] != 2:
        raise PrunusError(f"edges: shape {pairs.shape}; expected (E, 2)")
    _check_indices("edges", pairs, count)
    pairs = np.sort(pairs.astype(np.int64), axis=1)
    if (cloud.xyz[pairs[:, 0]] == cloud.xyz[pairs[:, 1]]).all(axis=1).any():
        raise PrunusError("edges: one joins two nodes in the same place; expected a length")
    values = np.asarray(confidence, np.float64)
    if values.shape != (len(pairs),) or not ((values >= 0) & (values <= 1)).all():
        raise PrunusError(
            f"confidence: shape {values.shape}; expected {len(pairs)} numbers from 0 to 1"
        )
    order = np.lexsort([pairs[:, 1], pairs[:, 0]])
    pairs, values = pairs[order], values[order]
    if (pairs[1:] == pairs[:-1]).all(axis=1).any():
        raise PrunusError("edges: a pair stands twice; expected each once, in either direction")
    own = Superpoints.of_nodes(cloud, params.superpoints.r_super)
    return ScoredGraph.of_confidence(CandidateGraph(own, pairs), values, "given")


def _check_indices(name: str, indices: NDArray[np.int64], count: int) -> None:
    if not np.issubdtype(indices.dtype, np.integer):
        raise PrunusError(f"{name}: {indices.dtype}; expected integers, indices of nodes")
    if indices.size and (indices.min() < 0 or indices.max() >= count):
        raise PrunusError(
            f"{name}: holds {indices.min()} to {indices.max()}; expected 0 to {count - 1}"
        )
