"""Spanning forests."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from prunus.paper.kernels.forest import spanning_forest
from tests import reference


@settings(deadline=None, max_examples=40)
@given(seed=st.integers(0, 10_000), nodes=st.integers(2, 15), count=st.integers(0, 40))
def test_kruskal_takes_the_same_edges(seed: int, nodes: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    edges = rng.integers(0, nodes, (count, 2))
    edges = edges[edges[:, 0] != edges[:, 1]]
    order = rng.permutation(len(edges))
    fast = spanning_forest(nodes, edges, order)
    assert fast.tolist() == reference.spanning_forest(nodes, edges, order).tolist()
