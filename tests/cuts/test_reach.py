"""The way of a tool to a cut, among drawn points."""

import numpy as np
import pytest

from prunus.cuts.reach import FREE, WAYS, approach, blade_normal, samples
from prunus.model import Floats

CUT, UP = np.zeros(3), np.array([0.0, 0.0, 1.0])
NOTHING = np.zeros((0, 3))


def post(x: float, y: float) -> Floats:
    """Points of an upright post, its middle at (x, y), closer than the cubes that thin them."""
    heights = np.arange(-0.5, 0.5, 0.004)
    return np.column_stack([np.full(len(heights), x), np.full(len(heights), y), heights])


def angle_to(way: tuple[float, float, float], point: Floats) -> float:
    """Degrees between the line by which the tool comes and a point, as seen from the cut."""
    cosine = -np.array(way) @ point / np.linalg.norm(point)
    return float(np.degrees(np.arccos(np.clip(cosine, -1, 1))))


def test_ways_come_from_the_side_of_the_camera() -> None:
    assert np.linalg.norm(WAYS, axis=1) == pytest.approx(np.ones(len(WAYS)))
    assert (WAYS[:, 1] < 0).all()


def test_in_the_open_a_tool_comes_straight_ahead_and_square_to_the_branch() -> None:
    way = approach(CUT, UP, NOTHING, NOTHING)
    assert way.half_angle == 90 and way.free_within == FREE
    assert angle_to(way.direction, np.array([0, -1, 0])) < 10
    assert abs(way.direction[2]) < 0.1


def test_the_cone_ends_where_the_first_point_stands() -> None:
    way = approach(CUT, UP, post(0.0, -0.2), NOTHING)
    assert 0 < way.half_angle < 90
    points = post(0.0, -0.2)
    points = points[np.linalg.norm(points, axis=1) < FREE]
    nearest = min(angle_to(way.direction, point) for point in points)
    assert way.half_angle <= nearest
    assert way.half_angle >= nearest - np.degrees(np.arcsin(0.005 / 0.12)) - 2, "a cube's width"
    assert abs(way.direction[0]) > 0.3, "it comes from beside the post"


def test_a_branch_towards_the_camera_is_not_approached_head_on() -> None:
    way = approach(CUT, np.array([0.0, -1.0, 0.0]), NOTHING, NOTHING)
    assert angle_to(way.direction, np.array([0, -1, 0])) > 40


def test_what_comes_down_stands_in_no_way() -> None:
    wood = np.column_stack([np.zeros((60, 2)), np.linspace(0.0, 0.4, 60)])
    smeared = wood - np.array([0.0, 0.01, 0.0])
    assert approach(CUT, UP, smeared, NOTHING).half_angle < 90
    assert approach(CUT, UP, smeared, wood).half_angle == 90


def test_points_at_the_blade_and_far_ones_do_not_matter() -> None:
    points = np.array([[0.0, -0.01, 0.0], [0.0, -0.4, 0.0]])
    assert approach(CUT, UP, points, NOTHING).half_angle == 90


def test_walled_in_there_is_no_cone_and_the_first_point_is_told() -> None:
    rng = np.random.default_rng(0)
    ball = rng.normal(size=(40_000, 3))
    wall = 0.1 * ball / np.linalg.norm(ball, axis=1, keepdims=True)
    way = approach(CUT, UP, wall, NOTHING)
    assert way.half_angle == 0
    assert way.free_within == pytest.approx(0.1, abs=1e-6)


def test_the_blade_moves_in_its_own_plane_and_is_as_square_as_it_can_be() -> None:
    direction = np.array([0.0, 1.0, 0.0])
    heading = np.array([0.0, 0.6, 0.8])
    normal = blade_normal(heading, direction)
    assert normal == pytest.approx([0, 0, 1])
    assert blade_normal(UP, direction) == pytest.approx(UP)


def test_samples_follow_the_edges_to_their_ends() -> None:
    xyz = np.array([[0.0, 0, 0], [0.0, 0, 0.025], [0.5, 0, 0]])
    found = samples(xyz, np.array([-1, 0, 0]), np.array([1]))
    assert found[-1] == pytest.approx(xyz[1])
    assert np.diff(found[:, 2]) == pytest.approx([0.025 / 3] * 2)
    assert samples(xyz, np.array([-1, 0, 0]), np.array([], int)).shape == (0, 3)
