import numpy as np
import pytest

from prunus.studio.camera import FOV, VIEWS, Eye, standing
from prunus.studio.picking import Ray, first_point, nearest_edge, nearest_point

FORWARD = Ray(np.zeros(3), np.array([0.0, 1.0, 0.0]), 0.001)
"""Along Y; a pixel is a millimetre at one metre."""


def test_the_edge_seen_nearest_is_picked_and_not_the_one_nearest_in_space() -> None:
    beside_near = [[0.004, 1, -1], [0.004, 1, 1]]
    beside_far = [[0.006, 4, -1], [0.006, 4, 1]]
    edges = np.array([beside_near, beside_far])
    assert nearest_edge(FORWARD, edges, 10) == 1


def test_nothing_is_picked_too_far_beside_or_behind() -> None:
    edge = np.array([[[0.02, 1.0, -1.0], [0.02, 1.0, 1.0]]])
    assert nearest_edge(FORWARD, edge, 10) is None
    assert nearest_edge(FORWARD, edge, 30) == 0
    assert nearest_edge(FORWARD, edge * [1, -1, 1], 30) is None
    assert nearest_point(FORWARD, np.array([[0.0, -1.0, 0.0]]), 10) is None
    assert nearest_edge(FORWARD, np.zeros((0, 2, 3)), 10) is None


def test_an_edge_that_passes_the_eye_is_picked_where_it_is_in_front() -> None:
    past = np.array([[[0.1, -1.0, 0.0], [-0.06, 1.0, 0.0]]])
    assert nearest_edge(FORWARD, past, 5) == 0
    aside = np.array([[[0.5, -1.0, 0.0], [0.3, 1.0, 0.0]]])
    assert nearest_edge(FORWARD, aside, 5) is None


def test_of_points_in_line_the_first_hides_the_others() -> None:
    points = np.array([[0.0, 3.0, 0.0], [0.001, 2.0, 0.0], [0.5, 1.0, 0.0]])
    assert first_point(FORWARD, points, 4) == 1
    assert nearest_point(FORWARD, points, 4) == 0


def looking(view: str) -> Eye:
    """The eye of a named view of a box of 2 x 1 x 3 m."""
    high = np.array([1.0, 0.5, 1.5])
    position, aim = standing(view, -high, high, 1.25)
    forward = (aim - position) / np.linalg.norm(aim - position)
    up = np.array([0.0, 0.0, 1.0])
    right = np.cross(forward, up) / np.linalg.norm(np.cross(forward, up))
    rotation = np.column_stack([right, np.cross(forward, right), forward])
    return Eye(position=position, rotation=rotation, fov=FOV, width=1000, height=800)


@pytest.mark.parametrize("view", VIEWS)
def test_a_named_view_shows_all_of_the_tree(view: str) -> None:
    signs = np.stack(np.meshgrid(*[[-1, 1]] * 3), axis=-1).reshape(-1, 3)
    image = looking(view).image(signs * [1.0, 0.5, 1.5])
    assert (image > 0).all() and (image < 1).all()
    assert np.ptp(image, axis=0).max() > 0.6


def test_what_is_seen_at_a_place_lies_on_the_ray_of_that_place() -> None:
    eye = looking("front")
    place = np.array([0.4, 0.1, -0.9])
    u, v = eye.image(place[None])[0]
    ray = Ray(eye.position, (place - eye.position) / np.linalg.norm(place - eye.position), 0.001)
    assert nearest_point(ray, place[None], 0.5) == 0
    assert u > 0.5 and v > 0.5
