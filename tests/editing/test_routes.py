"""Routes over the candidate graph, against another implementation."""

from itertools import pairwise

import networkx as nx
import numpy as np
import pytest

from prunus.editing.routes import SURE, cheapest_way
from prunus.model import SeededGraph
from tests.paper.graphs import random_graph


def weighted(graph: SeededGraph, taken: set[int]) -> nx.Graph:
    known = nx.Graph()
    for (i, j), sure in zip(graph.edges.tolist(), graph.confidence.tolist(), strict=True):
        if not taken & {i, j}:
            known.add_edge(i, j, cost=np.linalg.norm(graph.xyz[i] - graph.xyz[j]) * (SURE - sure))
    return known


@pytest.mark.parametrize("seed", range(20))
def test_no_other_way_is_cheaper(seed: int) -> None:
    graph = random_graph(seed, nodes=30, edges=60)
    taken = {3, 7, 11}
    known = weighted(graph, taken - {3})
    way = cheapest_way(graph, 3, 20, taken)
    if way is None:
        assert 3 not in known or 20 not in known or not nx.has_path(known, 3, 20)
        return
    assert way[0] == 3
    assert way[-1] == 20
    assert not set(way[1:]) & taken
    told = sum(known.edges[pair]["cost"] for pair in pairwise(way))
    assert told == pytest.approx(nx.dijkstra_path_length(known, 3, 20, weight="cost"))
