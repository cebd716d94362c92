"""Depth images of simple things, worked out by hand."""

import numpy as np
import pytest

from prunus.lab.simulate.depth import (
    GROUND,
    NOTHING,
    draw_ground,
    draw_wood,
    fatten,
    fly,
    points_of,
)

FOCAL = 100.0


def blank(rows: int = 40, columns: int = 60) -> tuple[np.ndarray, np.ndarray]:
    return np.zeros((rows, columns)), np.full((rows, columns), NOTHING)


def test_a_pole_is_as_wide_as_it_looks_and_bulges_towards_the_camera() -> None:
    depth, owner = blank()
    start, end = np.array([[0.0, -1.0, 2.0]]), np.array([[0.0, 1.0, 2.0]])
    draw_wood(start, end, np.array([0.05]), FOCAL, depth, owner)
    wide = (owner[20] == 0).sum()
    assert wide == pytest.approx(2 * 0.05 * FOCAL / 2, abs=1)
    assert depth[20, 29:31] == pytest.approx(1.95, abs=0.01)


def test_the_nearer_of_two_poles_hides_the_other() -> None:
    depth, owner = blank()
    start = np.array([[0.0, -1.0, 2.0], [-1.0, 0.0, 1.0]])
    end = np.array([[0.0, 1.0, 2.0], [1.0, 0.0, 1.0]])
    draw_wood(start, end, np.array([0.05, 0.02]), FOCAL, depth, owner)
    assert owner[20, 30] == 1 and owner[5, 30] == 0


def test_wood_behind_the_camera_is_not_drawn() -> None:
    depth, owner = blank()
    draw_wood(
        np.array([[0.0, 0, -1]]), np.array([[0.0, 0, 2]]), np.array([0.1]), FOCAL, depth, owner
    )
    assert (owner == NOTHING).all()


def test_level_ground_is_met_where_the_ray_says() -> None:
    depth, owner = blank()
    level = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])
    draw_ground(level, np.array([0.0, 0.0, 1.0]), FOCAL, np.zeros((4, 4)), 0.1, depth, owner)
    assert (owner[:20] == NOTHING).all()
    down = (39.5 - 20) / FOCAL
    assert owner[39, 30] == GROUND and depth[39, 30] == pytest.approx(1 / down)


def test_near_surfaces_spill_over_their_edges_by_the_reach() -> None:
    depth, owner = blank()
    depth[:, 30], owner[:, 30] = 1.0, 7
    depth[:, 33], owner[:, 33] = 2.0, 8
    wider, whose = fatten(depth, owner, np.full(depth.shape, 2))
    assert (whose[20] == 7).sum() == 5
    assert wider[20, 32] == 1.0 and whose[20, 33] == 8 and wider[20, 36] == 0.0


def test_only_pixels_at_a_jump_fly_and_never_past_what_lies_behind() -> None:
    depth, _ = blank()
    depth[:, :30], depth[:, 30:] = 1.0, 2.0
    chance, share = np.zeros(depth.shape), np.full(depth.shape, 0.5)
    before = depth.copy()
    fly(depth, 0.03, chance, share)
    assert depth[20, 29] == pytest.approx(1 / 0.75)
    assert np.array_equal(np.delete(depth[5:-5, 5:-5], 24, 1), np.delete(before[5:-5, 5:-5], 24, 1))


def test_points_project_back_to_their_pixels() -> None:
    depth, _ = blank()
    depth[3, 50] = 1.5
    points, rows, columns = points_of(depth, FOCAL)
    x, y, z = points[0]
    assert (rows[0], columns[0], z) == (3, 50, 1.5)
    assert x / z * FOCAL + 30 == pytest.approx(50.5) and y / z * FOCAL + 20 == pytest.approx(3.5)
