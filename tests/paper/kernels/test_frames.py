"""Edge frames and edge images."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prunus.geometry.neighbours import within
from prunus.paper.kernels.frames import (
    HIGH,
    WIDE,
    edge_images,
    either_end,
    least_direction,
    room_for_ends,
)
from tests import reference


@settings(deadline=None, max_examples=40)
@given(seed=st.integers(0, 10_000))
def test_the_least_direction_is_that_of_the_svd(seed: int) -> None:
    points = np.random.default_rng(seed).normal(size=(20, 3)) * [3, 1, 0.3]
    points -= points.mean(axis=0)
    slow = np.linalg.svd(points)[2][2]
    assert abs(least_direction(points.T @ points) @ slow) == pytest.approx(1)


@settings(deadline=None, max_examples=40)
@given(seed=st.integers(0, 10_000))
def test_turning_half_round_turns_the_direction_bit_for_bit(seed: int) -> None:
    points = np.random.default_rng(seed).normal(size=(9, 3))
    half = np.array([-1.0, -1.0, 1.0])
    here = least_direction(points.T @ points)
    there = least_direction((points * half).T @ (points * half))
    assert np.array_equal(there * half, here) or np.array_equal(there * half, -here)


@settings(deadline=None, max_examples=30)
@given(seed=st.integers(0, 10_000))
def test_an_image_is_that_of_the_slow_twin_up_to_a_flip(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(150, 3)) * [0.08, 0.02, 0.1]
    nodes = np.array([[0.0, 0, -0.06], [0.02, 0, 0.07]])
    start, members = within(points, nodes, 0.1)
    (image,) = edge_images(points, nodes, start, members, np.array([[0, 1]]), 0.1)
    slow = reference.edge_image(points, nodes, 0.1, (HIGH, WIDE))
    assert image == pytest.approx(slow, abs=1e-6) or image[::-1] == pytest.approx(slow, abs=1e-6)


def test_points_on_a_line_and_no_points_give_an_image_without_nan() -> None:
    nodes = np.array([[0.0, 0, 0], [0.0, 0, 0.15], [5.0, 0, 0], [5.0, 0, 0.1]])
    line = np.column_stack([np.zeros(50), np.zeros(50), np.linspace(0, 0.15, 50)])
    start, members = within(line, nodes, 0.1)
    images = edge_images(line, nodes, start, members, np.array([[0, 1], [2, 3]]), 0.1)
    assert np.isfinite(images).all()
    assert images[0].max() == 1
    assert images[0][: HIGH // 2 - 1].sum() == 0
    assert images[1].sum() == 0


def test_an_edge_without_length_gives_an_empty_image() -> None:
    nodes = np.zeros((2, 3))
    start, members = within(nodes, nodes, 0.1)
    images = edge_images(nodes, nodes, start, members, np.array([[0, 1]]), 0.1)
    assert images.tolist() == np.zeros((1, HIGH, WIDE)).tolist()


@settings(deadline=None, max_examples=30)
@given(seed=st.integers(0, 10_000))
def test_turning_half_round_leaves_images_bit_for_bit(seed: int) -> None:
    rng = np.random.default_rng(seed)
    half = np.array([-1.0, -1.0, 1.0])
    points = rng.normal(size=(200, 3)) * [0.08, 0.02, 0.1]
    nodes = rng.normal(size=(5, 3)) * 0.05
    edges = np.argwhere(np.triu(np.ones((5, 5)), 1))
    start, members = within(points, nodes, 0.1)
    still = edge_images(points, nodes, start, members, edges, 0.1)
    turned = edge_images(points * half, nodes * half, start, members, edges, 0.1)
    assert np.array_equal(still, turned)


@settings(deadline=None, max_examples=30)
@given(seed=st.integers(0, 10_000))
def test_a_point_of_both_ends_comes_once_whatever_the_nodes_hold(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points, nodes = rng.integers(-99, 99, (30, 3)) / 8, rng.integers(-99, 99, (4, 3)) / 8
    held = [rng.choice(30, rng.integers(0, 20), replace=False) for _ in nodes]
    start = np.cumsum([0, *map(len, held)])
    edges = np.argwhere(np.triu(np.ones((4, 4)), 1))
    seen = np.full(len(points), -1)
    local = np.empty((3, room_for_ends(start)))
    for e, (a, b) in enumerate(edges):
        count = either_end(points, nodes, start, np.concatenate(held), edges, e, seen, local)
        slow = points[np.union1d(held[a], held[b])] - (nodes[a] + nodes[b]) / 2
        assert sorted(local[:, :count].T.tolist()) == sorted(slow.tolist())


def test_nodes_that_hold_only_themselves_show_both() -> None:
    nodes = np.array([[0.0, 0, 0], [0.03, 0.02, 0.1], [1.0, 1, 1]])
    own = np.arange(3)
    images = edge_images(nodes, nodes, np.arange(4), own, np.array([[0, 1], [1, 2]]), 0.1)
    assert images[0].sum() == 2
    assert images[1].sum() == 0
