"""Balls that cover a cloud against the slow twin; the ugly clouds first."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prunus.geometry.neighbours import cover, within
from tests import reference
from tests.drawn import clouds


@settings(deadline=None, max_examples=30)
@given(seed=st.integers(0, 1000), count=st.integers(1, 60), radius=st.floats(0.05, 3))
def test_within_finds_the_same_points(seed: int, count: int, radius: float) -> None:
    points = clouds(seed, count)
    centers = clouds(seed + 1, 7)
    start, members = within(points, centers, radius)
    found = [members[start[n] : start[n + 1]].tolist() for n in range(len(centers))]
    assert found == reference.within(points, centers, radius)


@settings(deadline=None, max_examples=30)
@given(seed=st.integers(0, 1000), count=st.integers(1, 60), radius=st.floats(0.05, 3))
def test_cover_gives_the_same_balls(seed: int, count: int, radius: float) -> None:
    points = clouds(seed, count)
    order = np.random.default_rng(seed).permutation(count)
    means, sizes = cover(points, order, radius)
    slow_means, slow_sizes = reference.cover(points, order, radius)
    assert sizes.tolist() == slow_sizes.tolist()
    assert means == pytest.approx(slow_means, abs=2**-20)
