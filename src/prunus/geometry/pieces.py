"""Connected components of graphs, and cheapest ways over them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components, dijkstra

from prunus.model.arrays import Floats, Ints


def matrix_of(edges: Ints, values: NDArray[Any], size: int) -> csr_array:
    """The matrix (N, N) of that size with a value at each pair of (E, 2)."""
    # scipy's algorithms on graphs took indices of 32 bits alone, before 1.15
    places = edges.T.astype(np.int32)
    return csr_array((values, (places[0], places[1])), (size, size))


def components(nodes: int, edges: Ints) -> Ints:
    """The component (N,) of each node, named by its lowest node."""
    matrix = matrix_of(edges, np.ones(len(edges)), nodes)
    _, piece = connected_components(matrix, directed=False)
    _, lowest = np.unique(piece, return_index=True)
    return np.asarray(lowest[piece], np.int64)


def cheapest(nodes: int, edges: Ints, cost: Floats, source: int) -> Floats:
    """Dijkstra: what the cheapest way from the source to each node (N,) costs, inf where none is.

    `cost` (E,) >= 0 is that of undirected edges (E, 2), each pair of nodes joined once at most.
    """
    matrix = matrix_of(edges, cost, nodes)
    return np.asarray(dijkstra(matrix, directed=False, indices=source), np.float64)
