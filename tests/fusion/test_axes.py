"""Clouds drawn together onto axes."""

import numpy as np
import pytest

from prunus.fusion.axes import contract, main_axis
from prunus.model import Floats


def rod(rng: np.random.Generator, along: Floats, length: float, thick: float, n: int) -> Floats:
    """Points (n, 3) evenly within `thick` of a line from the origin."""
    aside = rng.normal(0, 1, (n, 3))
    aside -= np.outer(aside @ along, along)
    aside *= (thick * np.sqrt(rng.random(n)) / np.linalg.norm(aside, axis=1))[:, None]
    return np.outer(rng.uniform(0, length, n), along) + aside


def test_the_main_axis_is_the_greatest_eigenvector(rng: np.random.Generator) -> None:
    for _ in range(50):
        half = rng.normal(size=(3, 3)) * [3, 1, 0.3]
        spread = half @ half.T
        values, vectors = np.linalg.eigh(spread)
        axis = np.empty(3)
        line = main_axis(spread, axis)
        if values[1] < 0.9 * values[2]:
            assert abs(axis @ vectors[:, 2]) == pytest.approx(1, abs=1e-6)
            assert line == pytest.approx(1 - values[1] / values[2], abs=1e-6)


def test_a_thick_branch_becomes_a_thread_along_its_axis(rng: np.random.Generator) -> None:
    along = np.array([0.6, 0.0, 0.8])
    points = rod(rng, along, 0.6, 0.02, 800)
    drawn, axis, line, _, around = contract(points, np.ones(len(points)), 0.05, 4)
    far = drawn @ along
    aside = np.linalg.norm(drawn - np.outer(far, along), axis=1)
    inner = (far > 0.05) & (far < 0.55)
    assert np.percentile(aside[inner], 95) < 0.006
    assert np.percentile(np.abs(axis[inner] @ along), 5) > 0.98
    assert np.median(line[inner]) > 0.95
    assert around.min() >= 1
    assert np.abs(far - points @ along).max() < 0.03, "points go across the branch only"


def test_where_branches_meet_it_is_least_like_a_line(rng: np.random.Generator) -> None:
    up, across = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])
    points = np.concatenate([rod(rng, up, 0.6, 0.015, 900), rod(rng, across, 0.4, 0.015, 600)])
    points[:900, 2] -= 0.3
    drawn, _, line, _, _ = contract(points, np.ones(len(points)), 0.05, 4)
    assert np.linalg.norm(drawn[line.argmin()]) < 0.04
