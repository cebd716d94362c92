"""Greatest cosines against their plain form."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prunus.kernels.cones import greatest_cosines


@settings(deadline=None, max_examples=30)
@given(seed=st.integers(0, 1000), ways=st.integers(1, 9), points=st.integers(1, 30))
def test_it_is_that_of_the_point_nearest_in_angle(seed: int, ways: int, points: int) -> None:
    rng = np.random.default_rng(seed)
    aim = rng.normal(size=(ways, 3))
    aim /= np.linalg.norm(aim, axis=1, keepdims=True)
    off = rng.normal(size=(points, 3))
    away = np.linalg.norm(off, axis=1)
    plain = (aim @ (off / away[:, None]).T).max(axis=1)
    assert greatest_cosines(aim, off, away) == pytest.approx(plain)


def test_where_nothing_stands_it_is_least() -> None:
    assert greatest_cosines(np.eye(3), np.zeros((0, 3)), np.zeros(0)).tolist() == [-1, -1, -1]
