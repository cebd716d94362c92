"""Edge profiles."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prunus.kernels import reference
from prunus.kernels.neighbours import within
from prunus.kernels.profiles import ALONG, AROUND, REACH, RINGS, STEPS, edge_drifts, edge_profiles

THERE = np.array([[0, 1]])
BACK = np.array([[1, 0]])


@settings(deadline=None, max_examples=40)
@given(seed=st.integers(0, 10_000))
def test_a_profile_is_that_of_the_slow_twin(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(300, 3)) * [0.08, 0.04, 0.1]
    nodes = rng.normal(size=(2, 3)) * 0.05
    start, members = within(points, nodes, 0.1)
    (profile,) = edge_profiles(points, nodes, start, members, THERE, 0.1)
    slow = reference.edge_profile(points, nodes, 0.1, REACH, ALONG, RINGS)
    assert profile.shape == (ALONG, AROUND)
    assert profile.tolist() == slow.tolist()
    (drift,) = edge_drifts(points, nodes, start, members, THERE, 0.1)
    assert drift == pytest.approx(reference.edge_drift(points, nodes, 0.1, REACH, STEPS), abs=1e-5)
    (back,) = edge_drifts(points, nodes, start, members, BACK, 0.1)
    assert back.tolist() == drift[::-1].tolist()


@settings(deadline=None, max_examples=40)
@given(seed=st.integers(0, 10_000))
def test_swapping_the_ends_reverses_the_profile_also_of_points_on_the_borders(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.integers(-8, 9, (300, 3)) / 64  # r = 1 / 8: bins are 1 / 32 long
    nodes = np.array([[0.0, 0, -1 / 16], [0.0, 0, 1 / 16]])
    if seed % 2:
        nodes += rng.integers(-2, 3, (2, 3)) / 64
    start, members = within(points, nodes, 0.125)
    there = edge_profiles(points, nodes, start, members, THERE, 0.125)
    back = edge_profiles(points, nodes, start, members, BACK, 0.125)
    assert there.sum() > 0
    assert back.tolist() == there[:, ::-1].tolist()


def test_points_are_counted_once_each_in_the_bins_they_are_drawn_in() -> None:
    nodes = np.array([[0.0, 0, -0.05], [0.0, 0, 0.05]])
    line = np.array([[0.0, 0, 0.001], [0.0, 0, 0.002], [0.0, 0, -0.001]])
    aside = np.array([[0.025, 0, 0.001], [0.0, 0.06, 0.001], [0.09, 0, 0.001]])
    beyond = np.array([[0.0, 0, 0.1499], [0.0, 0, 0.1501], [0.12, 0, 0]])
    points = np.concatenate([line, aside, beyond])
    start, members = np.array([0, 9, 18]), np.tile(np.arange(9), 2)
    (profile,) = edge_profiles(points, nodes, start, members, THERE, 0.1)
    assert profile[12].tolist() == [2, 0, 1, 0, 0, 1, 0, 1]
    assert profile[11].tolist() == [1, 0, 0, 0, 0, 0, 0, 0]
    assert profile[23].tolist() == [1, 0, 0, 0, 0, 0, 0, 0]
    assert profile.sum() == 7


def test_turning_about_the_edge_changes_nothing() -> None:
    rng = np.random.default_rng(0)
    points = rng.normal(size=(300, 3)) * [0.08, 0.04, 0.1]
    nodes = np.array([[0.0, 0, -0.06], [0.0, 0, 0.07]])
    c, s = np.cos(0.7), np.sin(0.7)
    turned = points @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    still, moved = (
        edge_profiles(xyz, nodes, *within(xyz, nodes, 0.1), THERE, 0.1) for xyz in (points, turned)
    )
    assert moved == pytest.approx(still)


def test_an_edge_without_points_or_without_length_gives_zeros() -> None:
    nodes = np.array([[0.0, 0, 0], [0.0, 0, 0], [5.0, 0, 0], [5.0, 0, 0.1]])
    start, members = within(nodes[:1], nodes, 0.1)
    profiles = edge_profiles(nodes[:1], nodes, start, members, np.array([[0, 1], [2, 3]]), 0.1)
    assert profiles.sum() == 0
