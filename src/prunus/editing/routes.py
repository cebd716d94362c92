"""Ways over the candidate graph for paths that a person draws."""

from __future__ import annotations

import numpy as np

from prunus.geometry.pieces import cheapest
from prunus.model import Floats, Ints, SeededGraph

SURE = 1.02
"""A metre of an edge costs this less its confidence: even a sure one costs a little."""


def cheapest_way(graph: SeededGraph, start: int, end: int, taken: set[int]) -> list[int] | None:
    """The superpoints of the cheapest way, both ends among them; None where there is none.

    It passes none of those taken, which may hold the start.
    """
    barred = np.zeros(len(graph.xyz), np.bool_)
    barred[[node for node in taken if node < len(barred)]] = True
    barred[start] = False
    kept = ~barred[graph.edges].any(axis=1)
    edges = graph.edges[kept]
    length = np.linalg.norm(graph.xyz[edges[:, 1]] - graph.xyz[edges[:, 0]], axis=1)
    cost = length * (SURE - graph.confidence[kept])
    far = cheapest(len(graph.xyz), edges, cost, start)
    if not np.isfinite(far[end]):
        return None
    way = [end]
    while way[-1] != start:
        way.append(_before(way[-1], edges, cost, far))
    return way[::-1]


def _before(node: int, edges: Ints, cost: Floats, far: Floats) -> int:
    """The node from which the cheapest way comes: the sums are the very ones of the search."""
    at = np.flatnonzero((edges == node).any(axis=1))
    other = edges[at].sum(axis=1) - node
    exact = other[far[other] + cost[at] == far[node]]
    return int(exact[far[exact].argmin()])
