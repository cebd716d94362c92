"""Spanning forests and components."""

import networkx
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prunus.kernels import reference
from prunus.kernels.forest import cheapest, components, spanning_forest


@settings(deadline=None, max_examples=40)
@given(seed=st.integers(0, 10_000), nodes=st.integers(2, 15), count=st.integers(0, 40))
def test_kruskal_takes_the_same_edges(seed: int, nodes: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    edges = rng.integers(0, nodes, (count, 2))
    edges = edges[edges[:, 0] != edges[:, 1]]
    order = rng.permutation(len(edges))
    fast = spanning_forest(nodes, edges, order)
    assert fast.tolist() == reference.spanning_forest(nodes, edges, order).tolist()


def test_components_are_named_by_their_lowest_node() -> None:
    edges = np.array([[4, 2], [1, 3], [3, 1]])
    assert components(6, edges).tolist() == [0, 1, 2, 1, 2, 5]
    assert components(2, np.zeros((0, 2), np.int64)).tolist() == [0, 1]


def test_cheapest_ways_are_those_of_networkx(rng: np.random.Generator) -> None:
    pairs = np.array([(i, j) for i in range(14) for j in range(i) if rng.random() < 0.2])
    cost = rng.random(len(pairs))
    graph = networkx.Graph()
    graph.add_nodes_from(range(15))
    graph.add_weighted_edges_from((i, j, c) for (i, j), c in zip(pairs.tolist(), cost, strict=True))
    known = networkx.single_source_dijkstra_path_length(graph, 3)
    expected = [known.get(node, np.inf) for node in range(15)]
    assert cheapest(15, pairs, cost, 3) == pytest.approx(expected)
