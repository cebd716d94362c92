"""Edge frames and edge images."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prunus.kernels import reference
from prunus.kernels.frames import HIGH, WIDE, edge_images, least_direction
from prunus.kernels.neighbours import within


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
