"""Cylinders become a tree along their axes."""

import numpy as np
import pytest
from bench.cylinders import Cylinders, skeleton_of

from prunus.model import Floats, Skeleton

UP, ALONG = (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)
Row = tuple[tuple[float, float, float], tuple[float, float, float], float, int]
"""Start, axis, length and parent."""
STEM: list[Row] = [((0, 0, 0), UP, 0.5, -1), ((0, 0, 0.5), UP, 0.5, 0)]


def cylinders(rows: list[Row]) -> Cylinders:
    """These, each as thick in millimetres as its row and 10 more."""
    start, axis, length, parent = (np.array(column) for column in zip(*rows, strict=True))
    return Cylinders(start, axis, length, 0.010 + 0.001 * np.arange(len(rows)), parent)


def way_to(tree: Skeleton, place: tuple[float, float, float]) -> Floats:
    """The places from the base to the node there, each once."""
    row = int(np.linalg.norm(tree.xyz - place, axis=1).argmin())
    way = [row]
    while tree.parent[way[-1]] >= 0:
        way.append(int(tree.parent[way[-1]]))
    places = tree.xyz[way[::-1]]
    return np.asarray(places[[True, *(np.abs(np.diff(places, axis=0)).sum(axis=1) > 0)]])


@pytest.mark.parametrize(
    ("more", "length", "tip", "way"),
    [
        ([], 1.0, (0, 0, 1), [(0, 0, 0), (0, 0, 0.5), (0, 0, 1)]),
        (  # on the bark of the stem, half way up its first piece
            [((0.02, 0, 0.25), ALONG, 0.3, 0)],
            1.32,
            (0.32, 0, 0.25),
            [(0, 0, 0), (0, 0, 0.25), (0.02, 0, 0.25), (0.32, 0, 0.25)],
        ),
        (  # past the end of its parent: from that end
            [((0, 0, 1.1), ALONG, 0.2, 1)],
            1.3,
            (0.2, 0, 1.1),
            [(0, 0, 0), (0, 0, 0.5), (0, 0, 1), (0, 0, 1.1), (0.2, 0, 1.1)],
        ),
        (  # the upper one first: the way to it runs past the lower one
            [((0, 0, 0.4), ALONG, 0.2, 0), ((0, 0, 0.1), ALONG, 0.2, 0)],
            1.4,
            (0.2, 0, 0.4),
            [(0, 0, 0), (0, 0, 0.1), (0, 0, 0.4), (0.2, 0, 0.4)],
        ),
        (  # a child before its parent
            [((0.3, 0, 0.7), UP, 0.1, 3), ((0, 0, 0.7), ALONG, 0.3, 1)],
            1.4,
            (0.3, 0, 0.8),
            [(0, 0, 0), (0, 0, 0.5), (0, 0, 0.7), (0.3, 0, 0.7), (0.3, 0, 0.8)],
        ),
    ],
)
def test_branches_leave_the_axis_where_they_are_nearest_to_it(
    more: list[Row],
    length: float,
    tip: tuple[float, float, float],
    way: list[tuple[float, float, float]],
) -> None:
    tree = skeleton_of(cylinders(STEM + more))
    assert tree.lengths.sum() == pytest.approx(length)
    assert way_to(tree, tip) == pytest.approx(np.array(way))


def test_what_hangs_on_nothing_is_left_out() -> None:
    tree = skeleton_of(cylinders([*STEM, ((1, 0, 0), UP, 2.0, -1), ((1, 0, 2), UP, 1.0, 2)]))
    assert tree.lengths.sum() == pytest.approx(1.0)
    assert (tree.xyz[:, 0] == 0).all()


def test_a_node_has_the_radius_of_its_cylinder() -> None:
    tree = skeleton_of(cylinders([*STEM, ((0.02, 0, 0.25), ALONG, 0.3, 0)]))
    on_stem = (tree.xyz[:, 0] == 0) & (tree.xyz[:, 2] < 0.5)
    assert tree.radius[on_stem] == pytest.approx(0.010)
    assert tree.radius[tree.xyz[:, 0] > 0] == pytest.approx(0.012)
