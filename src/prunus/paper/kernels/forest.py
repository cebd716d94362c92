"""Minimum spanning forest, by union and find."""

import numpy as np

from prunus.geometry.compiled import kernel
from prunus.model.arrays import Bools, Ints


@kernel
def root_of(parent: Ints, node: int) -> int:
    """The representative of the node's set; halves the path on the way."""
    while parent[node] != node:
        parent[node] = parent[parent[node]]
        node = parent[node]
    return node


@kernel
def spanning_forest(nodes: int, edges: Ints, order: Ints) -> Bools:
    """Kruskal: which edges (E,) a forest takes when they are tried in `order` (E,)."""
    parent = np.arange(nodes)
    taken = np.zeros(len(edges), np.bool_)
    for e in order:
        a = root_of(parent, edges[e, 0])
        b = root_of(parent, edges[e, 1])
        if a != b:
            parent[a] = b
            taken[e] = True
    return taken
