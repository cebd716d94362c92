"""When an edge is valid, in cases small enough to decide by hand."""

from itertools import pairwise

import numpy as np
import pytest

from prunus.io.labels import CATEGORIES
from prunus.lab.evaluate.seen import counting_rows
from prunus.lab.learn.edges.labels import INVALID, OTHER, TrueWood, categories, edge_labels
from prunus.model import Label, Skeleton
from tests.conftest import field_scan

LEADER, SIDE = int(Label.LEADER), int(Label.SIDE_BRANCH)


def polyline(*corners: tuple[float, float, float]) -> np.ndarray:
    """Points every 2 cm through the corners, the first left out."""
    parts = []
    for a, b in pairwise(corners):
        steps = round(np.linalg.norm(np.subtract(b, a)) / 0.02)
        parts.append(np.linspace(a, b, steps + 1)[1:])
    return np.concatenate(parts)


def upright_with_side_branch(x: float = 0.0) -> Skeleton:
    """A leader of 1 m at x, with a level side branch of 40 cm along +x at half its height."""
    leader = polyline((x, 0, 0), (x, 0, 1.0))
    side = polyline((x, 0, 0.5), (x + 0.4, 0, 0.5))
    xyz = np.concatenate([[[x, 0, 0]], leader, side])
    parent = [-1, *range(len(leader)), 25, *range(len(leader) + 1, len(xyz) - 1)]
    label = [LEADER] * (1 + len(leader)) + [SIDE] * len(side)
    return Skeleton.build(xyz, parent, label)


def judged(*ends: tuple[float, float, float], trees: list[Skeleton] | None = None) -> int:
    """The label of one edge."""
    wood = TrueWood.of(trees or [upright_with_side_branch()])
    return int(edge_labels(np.array(ends, float), np.array([[0, 1]]), wood)[0])


@pytest.mark.parametrize(
    ("case", "ends", "expected"),
    [
        ("along the leader", [(0, 0, 0.1), (0, 0, 0.25)], LEADER),
        ("beside it, within 6 cm", [(0.055, 0, 0.1), (0.055, 0, 0.25)], LEADER),
        ("beside it, beyond 6 cm", [(0.065, 0, 0.1), (0.065, 0, 0.25)], INVALID),
        ("along the side branch", [(0.15, 0.01, 0.5), (0.3, 0, 0.5)], SIDE),
        ("across a thick leader", [(-0.04, 0, 0.3), (0.04, 0, 0.3)], INVALID),
        ("away from the leader", [(0, 0, 0.2), (0.18, 0, 0.25)], INVALID),
        ("cutting a corner with legs of 7 cm", [(0, 0, 0.43), (0.07, 0, 0.5)], LEADER),
        ("cutting a corner with legs of 14 cm", [(0, 0, 0.36), (0.14, 0, 0.5)], INVALID),
        ("from beyond the tip", [(0, 0, 0.95), (0, 0, 1.1)], INVALID),
    ],
)
def test_an_edge_is_valid_where_it_follows_the_wood(
    case: str, ends: list[tuple[float, float, float]], expected: int
) -> None:
    found = judged(*ends)
    assert found == expected or (case.startswith("cutting") and {found, expected} == {LEADER, SIDE})
    assert judged(*ends[::-1]) == found


def test_an_edge_from_one_tree_to_another_is_invalid_though_near_wood_all_along() -> None:
    trees = [upright_with_side_branch(), upright_with_side_branch(0.1)]
    assert judged((0, 0, 0.1), (0.1, 0, 0.2), trees=trees) == INVALID
    assert judged((0, 0, 0.1), (0, 0, 0.2), trees=trees) == LEADER


def test_two_leaders_of_one_tree_are_not_joined_where_they_run_side_by_side() -> None:
    one = polyline((0, 0, 0), (-0.06, 0, 0.3), (-0.06, 0, 1))
    two = polyline((0, 0, 0), (0.06, 0, 0.3), (0.06, 0, 1))
    xyz = np.concatenate([[[0, 0, 0]], one, two])
    parent = [-1, *range(len(one)), 0, *range(len(one) + 1, len(xyz) - 1)]
    tree = Skeleton.build(xyz, parent, [LEADER] * len(xyz))
    assert judged((-0.06, 0, 0.7), (0.06, 0, 0.75), trees=[tree]) == INVALID
    assert judged((-0.06, 0, 0.7), (-0.06, 0, 0.85), trees=[tree]) == LEADER


def test_shoots_on_a_support_are_other_wood_and_those_on_leaders_side_branches() -> None:
    xyz = [(0, 0, 0), (0, 0, 0.2), (0.2, 0, 0.2), (0.2, 0, 0.4), (0.3, 0, 0.4), (0.2, 0.1, 0.2)]
    tree = Skeleton.build(xyz, [-1, 0, 1, 2, 3, 2], [0, 0, 1, 2, 3, 3])
    assert categories(tree).tolist() == [0, 0, 1, 2, 3, OTHER]
    assert CATEGORIES[OTHER] == "other"


def test_wood_counts_from_the_first_to_the_last_place_where_the_scan_holds_it() -> None:
    tree = upright_with_side_branch()
    z = np.r_[np.arange(0.2, 0.4, 0.01), np.arange(0.55, 0.7, 0.01)]
    points = np.column_stack([0 * z + 0.02, 0 * z, z])
    counting = counting_rows(tree, points, np.zeros(len(points), int))
    height = tree.xyz[1:51, 2]
    assert counting[1:51].tolist() == ((height > 0.155) & (height < 0.735)).tolist()
    assert not counting[51:].any()


def test_branches_mostly_unseen_or_under_10_cm_do_not_count() -> None:
    tree = upright_with_side_branch()
    rare = np.array([[0.06, 0, 0.5], [0.39, 0, 0.5]])
    assert not counting_rows(tree, rare, np.ones(2, int)).any()
    short = np.column_stack([np.arange(0.0, 0.04, 0.01), np.zeros(4), np.full(4, 0.5)])
    assert not counting_rows(tree, short, np.ones(4, int)).any()
    long = np.column_stack([np.arange(0.0, 0.2, 0.01), np.zeros(20), np.full(20, 0.5)])
    counting = counting_rows(tree, long, np.ones(20, int))
    assert counting[51:61].all() and not counting[:51].any()
    wood = TrueWood.of([tree], [counting])
    ends = np.array([[0.0, 0, 0.1], [0.0, 0, 0.25], [0.02, 0, 0.5], [0.18, 0, 0.5]])
    assert edge_labels(ends, np.array([[0, 1], [2, 3]]), wood).tolist() == [INVALID, SIDE]


def test_the_edges_of_the_truth_itself_are_valid_and_carry_its_labels() -> None:
    tree = field_scan(11).row.trees[0]
    wood = TrueWood.of(field_scan(11).row.trees)
    rows = np.flatnonzero(tree.label == Label.LEADER)
    rows = rows[tree.label[tree.parent[rows]] == Label.LEADER]
    rows = np.array([r for r in rows if tree.parent[r] == r - 1 and tree.parent[r - 1] == r - 2])
    edges = np.column_stack([tree.parent[tree.parent[rows]], rows])
    assert (edge_labels(tree.xyz, edges, wood) >= 0).all()
