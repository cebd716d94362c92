"""Places on lines against the slow twin."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prunus.refine.lines import nearest_on_lines
from tests import reference

LINE = np.array([[0.0, 0, 0], [0.1, 0, 0], [0.2, 0, 0]])


@settings(deadline=None, max_examples=40)
@given(seed=st.integers(0, 1000), reach=st.floats(0.1, 1.5))
def test_points_find_the_same_places(seed: int, reach: float) -> None:
    rng = np.random.default_rng(seed)
    line = np.repeat([0, 1, 2], [5, 2, 6])
    station, points = rng.uniform(-1, 1, (13, 3)), rng.uniform(-1, 1, (30, 3))
    before, share, away = nearest_on_lines(points, station, line, reach)
    slow = reference.nearest_on_lines(points, station, line, reach)
    assert before.tolist() == [place[0] for place in slow]
    assert share == pytest.approx([place[1] for place in slow])
    assert away == pytest.approx([place[2] for place in slow])


def test_a_point_half_way_lies_half_way() -> None:
    before, share, away = nearest_on_lines(
        np.array([[0.15, 0.02, 0.0]]), LINE, np.zeros(3, np.int64), 0.1
    )
    assert (before[0], share[0], away[0]) == pytest.approx((1, 0.5, 0.02))


def test_no_place_is_between_two_lines() -> None:
    before, share, _ = nearest_on_lines(
        np.array([[0.16, 0.0, 0.0]]), LINE, np.array([0, 0, 1]), 0.1
    )
    assert before[0] == -1
    before, share, _ = nearest_on_lines(
        np.array([[0.14, 0.0, 0.0]]), LINE, np.array([0, 0, 1]), 0.1
    )
    assert (before[0], share[0]) == (0, 1.0)
