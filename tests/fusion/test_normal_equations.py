"""Partners and normal equations, against slow and obvious twins."""

import numpy as np
import pytest

from prunus.fusion.normal_equations import normal_equations, partners, residuals
from prunus.model import Floats, Ints

V = 3


def samples(rng: np.random.Generator, count: int) -> tuple[Floats, Floats, Floats, Ints]:
    """Samples of any axes and any covariances, in V views."""
    axis = rng.normal(size=(count, 3))
    axis /= np.linalg.norm(axis, axis=1, keepdims=True)
    root = rng.normal(size=(count, 3, 3))
    doubt = root @ root.transpose(0, 2, 1) + 0.1 * np.eye(3)
    return rng.uniform(-1, 1, (count, 3)), axis, doubt, rng.integers(0, V, count)


def test_partners_are_those_of_a_search_through_all(rng: np.random.Generator) -> None:
    xyz, axis, _, view = samples(rng, 120)
    away = np.linalg.norm(xyz[:, None] - xyz, axis=2)
    away[(view[:, None] == view) | (np.abs(axis @ axis.T) < 0.7) | (away >= 0.6)] = np.inf
    found = partners(xyz, axis, view, V, 0.6, 0.7)
    for v in range(V):
        of_view = np.where(view == v, away, np.inf)
        expected = np.where(np.isinf(of_view.min(axis=1)), -1, of_view.argmin(axis=1))
        assert (found[:, v] == expected).all()
    assert (found >= 0).sum() > 50


def test_the_right_side_is_the_descent_of_the_robust_cost(rng: np.random.Generator) -> None:
    xyz, axis, doubt, view = samples(rng, 30)
    mates = partners(xyz, axis, view, V, 1.0, 0.5)
    scale, step = 1.5, 1e-6

    def cost(moves: Floats) -> float:
        """Half of the sum of e^2 / (1 + e^2 / scale^2), the views turned and moved a little."""
        turn, shift = moves.reshape(V, 6)[view, :3], moves.reshape(V, 6)[view, 3:]
        moved = xyz + np.cross(turn, xyz) + shift
        square = residuals(moved, axis, doubt, mates)[1] ** 2
        return float(np.nansum(square / (1 + square / scale**2)) / 2)

    matrix, right = normal_equations(xyz, axis, doubt, view, mates, scale)
    steps = step * np.eye(6 * V)
    slope = [(cost(one) - cost(-one)) / (2 * step) for one in steps]
    assert right == pytest.approx(-np.array(slope), rel=1e-5, abs=1e-5)
    assert matrix == pytest.approx(matrix.T)
    assert np.linalg.eigvalsh(matrix).min() > -1e-9


def test_all_moving_together_changes_no_residual(rng: np.random.Generator) -> None:
    xyz, axis, doubt, view = samples(rng, 60)
    mates = partners(xyz, axis, view, V, 0.8, 0.6)
    matrix, _ = normal_equations(xyz, axis, doubt, view, mates, 3.0)
    together = np.tile([0.0, 0, 0, 0.3, -0.2, 0.5], V)
    assert matrix @ together == pytest.approx(np.zeros(6 * V), abs=1e-9)


def test_sliding_along_a_branch_is_no_residual() -> None:
    xyz = np.array([[0, 0, 0], [0.003, 0.004, 0.5]])
    axis = np.array([[0, 0, 1.0], [0, 0, -1.0]])
    doubt = np.tile(np.eye(3) * 0.5 * 0.001**2, (2, 1, 1))
    metres, deviations = residuals(xyz, axis, doubt, np.array([[-1, 1], [-1, -1]]))
    assert metres[0, 1] == pytest.approx(0.005) and deviations[0, 1] == pytest.approx(5.0)
    assert np.isnan(metres[1]).all()
