"""To which tree each node belongs, and the cheapest ways from its foot: Dijkstra's algorithm.

Both run from all feet at once, the second within each tree.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse.csgraph import dijkstra

from prunus.growth.graph import ThreadGraph
from prunus.model import Floats, Ints

NOWHERE = -1


@dataclass(frozen=True, eq=False, kw_only=True)
class Ways:
    """For each of N nodes the one before it, the foot it grows from (`NOWHERE`: none), and metres.

    `before` of a foot is NOWHERE; `length` is that of the way from the foot, infinite where none.
    """

    before: Ints
    foot: Ints
    length: Floats


def cheapest(graph: ThreadGraph, feet: Ints) -> Ints:
    """The foot (N,) of the tree as whose wood each node costs least, `NOWHERE` = of none."""
    cost, _, foot = dijkstra(graph.belonging, indices=feet, return_predecessors=True, min_only=True)
    return np.where(np.isfinite(cost), foot, NOWHERE)


def find_ways(graph: ThreadGraph, feet: Ints, tree: Ints) -> Ways:
    """The cheapest way to each node from the foot of its tree (N,), within that tree."""
    cost, before, foot = dijkstra(
        graph.within(tree), indices=feet, return_predecessors=True, min_only=True
    )
    reached = np.isfinite(cost) & (tree != NOWHERE)
    before = np.where(reached & (before >= 0), before, NOWHERE)
    return Ways(
        before=before,
        foot=np.where(reached, foot, NOWHERE),
        length=_lengths(graph.threads.xyz, before, cost),
    )


def _lengths(xyz: Floats, before: Ints, cost: Floats) -> Floats:
    step = np.linalg.norm(xyz - xyz[np.maximum(before, 0)], axis=1).tolist()
    parent = before.tolist()
    length = np.where(np.isfinite(cost), 0.0, np.inf).tolist()
    for node in np.argsort(cost, kind="stable").tolist():
        if parent[node] >= 0:
            length[node] = length[parent[node]] + step[node]
    return np.array(length)
