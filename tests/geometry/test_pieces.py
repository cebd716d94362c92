"""Components and cheapest ways."""

import networkx
import numpy as np
import pytest

from prunus.geometry.pieces import cheapest, components


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


def test_ways_over_edges_that_cost_nothing_cost_nothing() -> None:
    assert cheapest(3, np.array([[0, 1], [1, 2]]), np.zeros(2), 0).tolist() == [0, 0, 0]
