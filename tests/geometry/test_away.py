"""The distance from a line of nodes against the slow twin."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prunus.geometry.near import away_from
from tests import reference


@settings(deadline=None, max_examples=30)
@given(seed=st.integers(0, 1000), nodes=st.integers(1, 7), double=st.booleans())
def test_distances_are_those_of_the_twin(seed: int, nodes: int, double: bool) -> None:
    rng = np.random.default_rng(seed)
    points, line = rng.uniform(-1, 1, (20, 3)), rng.uniform(-1, 1, (nodes, 3))
    if double:
        line = np.repeat(line, 2, axis=0)
    assert away_from(points, line) == pytest.approx(np.array(reference.away_from(points, line)))


def test_before_the_first_and_after_the_last_node_the_ends_count() -> None:
    line = np.array([[0.0, 0, 0], [1.0, 0, 0]])
    points = np.array([[-3.0, 4, 0], [0.5, 2, 0], [4.0, 0, 4]])
    assert away_from(points, line) == pytest.approx([5, 2, 5])
