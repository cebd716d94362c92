"""Points chosen by shape: drawn cases with the answer worked out by hand."""

import numpy as np
import pytest

from prunus.editing import Box, Brush, Class, Component, Lasso, Mark, Refused, Slab
from prunus.editing.marks import chosen, inside
from prunus.editing.state import State, apply
from prunus.model import Kind, PointCloud
from prunus.model.cloud import FRAMES
from tests.editing.trees import outside, state

FRONT = ((1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))
"""Sees X to the right and Z up, from anywhere along Y."""
SQUARE = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))


def scan(points: list[tuple[float, float, float]]) -> PointCloud:
    return PointCloud.from_xyz(np.array(points))


def kinds(cloud: PointCloud, *other: int) -> np.ndarray:
    kind = np.zeros(len(cloud), np.int8)
    kind[list(other)] = Kind.POST
    return kind


def rows(found: np.ndarray) -> list[int]:
    return np.flatnonzero(found).tolist()


def test_a_box_holds_what_is_between_its_corners() -> None:
    cloud = scan([(0, 0, 0), (1, 1, 1), (2, 2, 2), (1, 1, 3)])
    assert rows(chosen(Box((0.5, 0.5, 0.5), (2.5, 2.5, 2.5)), cloud, kinds(cloud))) == [1, 2]


def test_shapes_are_in_the_frame_of_the_file() -> None:
    points = np.array([(500.0, 1.0, 2.0), (501.0, 1.0, 2.0)])
    cloud = PointCloud.from_xyz(points, "optical")
    assert not np.allclose(FRAMES["optical"], np.eye(3))
    for shape in (
        Box((500.5, 0.5, 1.5), (501.5, 1.5, 2.5)),
        Brush(((501.0, 1.0, 2.1),), 0.2),
        Component((501.0, 1.0, 2.1)),
        Lasso(((500.5, 0.0), (502.0, 0.0), (502.0, 3.0), (500.5, 3.0)), FRONT),
    ):
        assert rows(chosen(shape, cloud, kinds(cloud))) == [1]


def test_a_lasso_holds_what_it_surrounds_in_the_image_however_deep() -> None:
    cloud = scan([(0, -9, 0), (0.5, 9, 0.5), (1.5, 0, 0), (0, 0, -1.5)])
    assert rows(chosen(Lasso(SQUARE, FRONT), cloud, kinds(cloud))) == [0, 1]


def test_what_the_slab_hid_is_not_lassoed() -> None:
    cloud = scan([(0, -9, 0), (0.5, 9, 0.5)])
    shown = Slab((0.0, 1.0, 0.0), -10.0, 0.0)
    assert rows(chosen(Lasso(SQUARE, FRONT, shown), cloud, kinds(cloud))) == [0]


def test_what_is_behind_the_camera_is_not_lassoed() -> None:
    """A camera at the origin that looks along Y: the image of (x, y, z) is (x / y, z / y)."""
    camera = (*FRONT[:3], (0.0, 1.0, 0.0, 0.0))
    cloud = scan([(0.1, 1, 0.1), (0.1, -1, 0.1), (5, 2, 0), (5, 10, 0)])
    assert rows(chosen(Lasso(SQUARE, camera), cloud, kinds(cloud))) == [0, 3]


def test_a_polygon_with_a_bay_leaves_the_bay_out() -> None:
    bay = np.array([(0, 0), (4, 0), (4, 4), (2, 1), (0, 4)], float)
    points = np.array([(2, 0.5), (2, 2), (0.5, 2), (3.5, 2), (5, 1), (2, -1)], float)
    assert inside(points, bay).tolist() == [True, False, True, True, False, False]


def test_a_brush_holds_what_is_near_its_stroke() -> None:
    cloud = scan([(0, 0, 0), (0.5, 0, 0), (1, 0, 0), (3, 0, 0)])
    stroke = Brush(((0.1, 0.0, 0.0), (0.9, 0.0, 0.0)), 0.2)
    assert rows(chosen(stroke, cloud, kinds(cloud))) == [0, 2]


def test_a_component_is_what_hangs_together_and_is_of_one_kind() -> None:
    line = [(0.04 * k, 0.0, 0.0) for k in range(10)]
    cloud = scan([*line, (2.0, 0.0, 0.0)])
    assert rows(chosen(Component((0.0, 0.0, 0.0)), cloud, kinds(cloud))) == list(range(10))
    cut = kinds(cloud, 4, 5, 6)
    assert rows(chosen(Component((0.0, 0.0, 0.0)), cloud, cut)) == [0, 1, 2, 3]
    assert rows(chosen(Component((9.0, 0.0, 0.0)), cloud, cut)) == []


@pytest.mark.parametrize("gap", [1e-9, 0.02, 0.1, 50.0])
def test_components_part_a_cloud(gap: float, rng: np.random.Generator) -> None:
    cloud = PointCloud.from_xyz(rng.uniform(-1, 1, (200, 3)))
    kind = kinds(cloud)
    left = np.ones(len(cloud), bool)
    while left.any():
        at = cloud.to_input.apply(cloud.xyz[left.argmax()])
        piece = chosen(Component(tuple(at.tolist()), gap), cloud, kind)
        assert piece[left.argmax()]
        assert left[piece].all(), "no point is in two pieces"
        left &= ~piece


def test_a_class_is_all_points_of_a_kind() -> None:
    cloud = scan([(0, 0, 0), (1, 0, 0), (2, 0, 0)])
    assert rows(chosen(Class(Kind.POST), cloud, kinds(cloud, 1))) == [1]


def test_marks_are_on_the_scan_and_the_tree_waits_for_the_rebuild() -> None:
    at = state()
    place = outside(at, at.scan.xyz[5])
    after = apply(at, Mark(Brush((place,), 0.02), Kind.WIRE))
    assert rows(after.kind == Kind.WIRE) == [5]
    assert after.marked
    assert after.draft is at.draft
    assert not at.marked
    assert rows(at.kind != Kind.TARGET) == []


def test_a_mark_that_changes_nothing_is_refused() -> None:
    at: State = state()
    with pytest.raises(Refused, match="no point was chosen"):
        apply(at, Mark(Class(Kind.GROUND), Kind.TARGET))
