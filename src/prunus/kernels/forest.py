"""Minimum spanning forest and connected components, by union and find; cheapest ways."""

from heapq import heappop, heappush

import numpy as np

from prunus.kernels.compiled import kernel
from prunus.model.arrays import Bools, Floats, Ints


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


@kernel
def components(nodes: int, edges: Ints) -> Ints:
    """The component (N,) of each node, named by its lowest node."""
    parent = np.arange(nodes)
    for e in range(len(edges)):
        a = root_of(parent, edges[e, 0])
        b = root_of(parent, edges[e, 1])
        parent[max(a, b)] = min(a, b)
    for n in range(nodes):
        parent[n] = root_of(parent, n)
    return parent


@kernel
def cheapest(nodes: int, edges: Ints, cost: Floats, source: int) -> Floats:
    """Dijkstra: what the cheapest way from the source to each node (N,) costs, inf where none is.

    `cost` (E,) >= 0 is that of undirected edges (E, 2).
    """
    E = len(edges)
    start = np.zeros(nodes + 1, np.int64)
    for e in range(E):
        start[edges[e, 0] + 1] += 1
        start[edges[e, 1] + 1] += 1
    start = np.cumsum(start)
    free, held = start[:-1].copy(), np.empty(2 * E, np.int64)
    for e in range(E):
        for end in range(2):
            held[free[edges[e, end]]] = e
            free[edges[e, end]] += 1
    distance = np.full(nodes, np.inf)
    distance[source] = 0.0
    heap = [(0.0, source)]
    while len(heap) > 0:
        far, n = heappop(heap)
        if far > distance[n]:
            continue
        for slot in range(start[n], start[n + 1]):
            e = held[slot]
            other = edges[e, 0] + edges[e, 1] - n
            if far + cost[e] < distance[other]:
                distance[other] = far + cost[e]
                heappush(heap, (distance[other], other))
    return distance
