"""Neighbours by scipy's tree against the slow twin; the ugly clouds first."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from prunus.geometry.near import nearest, within
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


def test_a_node_exactly_at_the_reach_counts() -> None:
    xyz, nodes = np.zeros((1, 3)), np.array([[0.5, 0, 0], [0, 0.7, 0]])
    assert nearest(xyz, nodes, 0.5).tolist() == [0]
    assert nearest(xyz, nodes, 0.49).tolist() == [-1]


def test_of_nothing_nothing_is_near() -> None:
    none, some = np.zeros((0, 3)), np.zeros((2, 3))
    assert [one.tolist() for one in within(none, some, 1.0)] == [[0, 0, 0], []]
    assert [one.tolist() for one in within(some, none, 1.0)] == [[0], []]
    assert nearest(some, none, 1.0).tolist() == [-1, -1]
    assert nearest(none, some, 1.0).tolist() == []
