"""Connected components of graphs, and cheapest ways over them."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components, dijkstra

from prunus.model.arrays import Floats, Ints


def components(nodes: int, edges: Ints) -> Ints:
    """The component (N,) of each node, named by its lowest node."""
    ones = np.ones(len(edges))
    matrix = csr_array((ones, (edges[:, 0], edges[:, 1])), shape=(nodes, nodes))
    _, piece = connected_components(matrix, directed=False)
    _, lowest = np.unique(piece, return_index=True)
    return np.asarray(lowest[piece], np.int64)


def cheapest(nodes: int, edges: Ints, cost: Floats, source: int) -> Floats:
    """Dijkstra: what the cheapest way from the source to each node (N,) costs, inf where none is.

    `cost` (E,) >= 0 is that of undirected edges (E, 2), each pair of nodes joined once at most.
    """
    matrix = csr_array((cost, (edges[:, 0], edges[:, 1])), shape=(nodes, nodes))
    return np.asarray(dijkstra(matrix, directed=False, indices=source), np.float64)
