"""Fast neighbours against the slow twin; the ugly clouds first."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prunus.kernels import reference
from prunus.kernels.neighbours import cover, nearest, within


def clouds(seed: int, count: int) -> np.ndarray:
    """Points on the model's grid, some of them in one place."""
    rng = np.random.default_rng(seed)
    points = np.rint(rng.uniform(-1, 1, (count, 3)) * 2**10) / 2**10
    points[count // 2 :: 3] = points[0]
    return points


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


def test_a_point_exactly_at_the_radius_counts() -> None:
    points = np.array([[0.0, 0, 0], [0.5, 0, 0], [0.5 + 2**-20, 0, 0]])
    _, members = within(points, points[:1], 0.5)
    assert members.tolist() == [0, 1]


def test_far_strays_cost_no_memory() -> None:
    points = np.array([[0.0, 0, 0], [1e6, -1e6, 1e6]])
    start, members = within(points, points, 0.1)
    assert members.tolist() == [0, 1]
    assert start.tolist() == [0, 1, 2]


def test_every_point_goes_to_its_nearest_node_within_reach(rng: np.random.Generator) -> None:
    xyz, nodes = rng.random((400, 3)), rng.random((20, 3))
    away = np.linalg.norm(xyz[:, None] - nodes[None], axis=2)
    expected = np.where(away.min(axis=1) <= 0.3, away.argmin(axis=1), -1)
    assert np.array_equal(nearest(xyz, nodes, 0.3), expected)
    assert (expected < 0).any()
