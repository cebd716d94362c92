"""The door for those who bring their own graph and confidences."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from prunus.errors import NoTreeError, PrunusError
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
from prunus.model.arrays import Shape, frozen
from prunus.paper.population import search
from prunus.paper.seeds import find_tips
from prunus.params import Parameters, checked_params, checked_seed


@dataclass(frozen=True, eq=False, kw_only=True)
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
    (E,) in [0, 1]; base and tips (T,) node indices, tips found as in the paper when None. params:
    those of the paper's method, which None is.
    Raises PrunusError naming the argument, what was found and what was expected, or where nothing
    can be grown from the base.
    """
    params = checked_params(_of_search(params))
    if params.method == "default":
        raise PrunusError(
            'params: of the method "default", which searches no graph; expected '
            "those of Parameters.paper()"
        )
    rng = np.random.default_rng(checked_seed(seed))
    graph = _checked_graph(nodes, edges, confidence, params)
    count = len(graph.xyz)
    root = int(_indices("base", [base], (1,), count)[0])
    if tips is None:
        ends = find_tips(graph.xyz, graph.edges, graph.confidence, params)
    else:
        ends = np.unique(_indices("tips", tips, (None,), count))
    ends = ends[ends != root]
    if len(ends) == 0:
        raise PrunusError("tips: none found; expected one or more nodes to grow to, not the base")
    seeded = SeededGraph(graph, root, ends)
    found = search(seeded, params, rng)
    if len(found.skeleton) == 1:
        raise NoTreeError(
            f"no tree was found: nothing that pays its way leaves the base, node {root} "
            f"({_degree(graph, root)} of {len(graph.edges)} edges meet there); expected edges of a "
            f"confidence over {params.confidence.alpha_conf:g} that lead upright from it to a tip"
        )
    back = graph.candidates.superpoints.cloud.to_input
    pairs = found.skeleton.superpoint[found.skeleton.edges]
    words = np.array([Label(label).word for label in found.skeleton.label[1:]], dtype=np.str_)
    return GraphSkeleton(
        edges=pairs,
        labels=words,
        score=found.score,
        history=found.history,
        skeleton=found.skeleton.moved(back),
    )


def _of_search(params: Any) -> Any:
    """Parameters that a caller gave; of nested dicts the method is the paper's."""
    if params is None:
        return Parameters.paper()
    return {"method": "paper", **params} if isinstance(params, Mapping) else params


def _checked_graph(
    nodes: ArrayLike, edges: ArrayLike, confidence: ArrayLike, params: Parameters
) -> ScoredGraph:
    cloud = PointCloud.from_xyz(frozen(nodes, np.float64, (None, 3), "nodes"))
    pairs = np.sort(_indices("edges", edges, (None, 2), len(cloud)), axis=1)
    if (pairs[:, 0] == pairs[:, 1]).any():
        raise PrunusError("edges: one joins a node to itself; expected two nodes")
    if (cloud.xyz[pairs[:, 0]] == cloud.xyz[pairs[:, 1]]).all(axis=1).any():
        raise PrunusError("edges: one joins two nodes in the same place; expected a length")
    values = frozen(confidence, np.float64, (len(pairs),), "confidence")
    if not ((values >= 0) & (values <= 1)).all():
        raise PrunusError(
            f"confidence: holds {values.min():.9g} to {values.max():.9g}; expected "
            f"{len(pairs)} numbers from 0 to 1"
        )
    order = np.lexsort([pairs[:, 1], pairs[:, 0]])
    pairs, values = pairs[order], values[order]
    if (pairs[1:] == pairs[:-1]).all(axis=1).any():
        raise PrunusError("edges: a pair stands twice; expected each once, in either direction")
    own = Superpoints.of_nodes(cloud, params.superpoints.r_super)
    return ScoredGraph.of_confidence(CandidateGraph(own, pairs), values, "given")


def _indices(name: str, indices: ArrayLike, shape: Shape, count: int) -> Ints:
    found: Ints = frozen(indices, np.int64, shape, name)
    if found.size and (found.min() < 0 or found.max() >= count):
        raise PrunusError(
            f"{name}: holds {found.min()} to {found.max()}; expected 0 to {count - 1}"
        )
    return found


def _degree(graph: ScoredGraph, node: int) -> int:
    return int((graph.edges == node).any(axis=1).sum())
