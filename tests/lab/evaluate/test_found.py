"""Branches found, their parents, supports and base, on drawn trees with numbers by hand."""

import math

import numpy as np
import pytest

from prunus.lab.evaluate.arms import arms, parents
from prunus.lab.evaluate.found import branch_measures
from prunus.model import Label, RigidMotion, Skeleton
from prunus.model.branches import branches
from tests.drawn import LABELS, TREE, tree

Line = tuple[str, list[tuple[float, float]]]

TRUNK: Line = ("t", [(0, 0), (0, 0.5)])
SUPPORT: Line = ("s", [(0, 0.5), (0.5, 0.5), (1, 0.5)])
LEFT: Line = ("s", [(0, 0.5), (-0.5, 0.5), (-1, 0.5)])
LEADER: Line = ("l", [(0.5, 0.5), (0.5, 2.5)])
"""A leader of two metres."""


def grown(*lines: Line) -> Skeleton:
    """A skeleton of labelled lines (x, z), each from a corner of an earlier one."""
    corners = [(0.0, 0.0)]
    parent, labels = [-1], [Label.TRUNK]
    for letter, (start, *others) in lines:
        below = corners.index(start)
        for corner in others:
            corners.append(corner)
            parent.append(below)
            labels.append(LABELS[letter])
            below = len(corners) - 1
    return Skeleton.build([(x, 0, z) for x, z in corners], parent, labels)


def leader(x: float, low: float, high: float) -> Line:
    return "l", [(x, low), (x, high)]


def test_a_tree_finds_all_of_itself() -> None:
    assert branch_measures(tree(), tree()) == {
        "leaders_true": 3,
        "leaders_found": 3,
        "leaders_found_share": 1,
        "leaders_predicted": 3,
        "false_leaders": 0,
        "leaders_parents_right": 3,
        "side_branches_true": 1,
        "side_branches_found": 1,
        "side_branches_found_share": 1,
        "side_branches_predicted": 1,
        "false_side_branches": 0,
        "side_branches_parents_right": 1,
        "parents_right_share": 1,
        "supports_true": 2,
        "supports_predicted": 2,
        "supports_right": 2,
        "supports_right_share": 1,
        "base_error": 0,
    }


def test_measures_are_plain_floats() -> None:
    assert {type(value) for value in branch_measures(tree(), tree()).values()} == {float}


def test_moving_both_trees_changes_nothing() -> None:
    turn = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    motion = RigidMotion(turn, np.array([3.0, -2, 7]))
    worse = tree(TREE.replace("l   lb l", "l   l bl"))
    assert branch_measures(worse.moved(motion), tree().moved(motion)) == branch_measures(
        worse, tree()
    )


def test_a_bare_base_finds_nothing_and_a_share_of_nothing_is_unknown() -> None:
    bare = Skeleton.build([[0, 0, 0]], [-1], [0])
    nothing = branch_measures(bare, tree())
    assert nothing["leaders_found_share"] == 0
    assert nothing["supports_right_share"] == 0
    assert math.isnan(nothing["parents_right_share"])
    without_truth = branch_measures(tree(), bare)
    assert math.isnan(without_truth["leaders_found_share"])
    assert math.isnan(without_truth["supports_right_share"])
    assert without_truth["false_leaders"] == 3


@pytest.mark.parametrize(("kept", "found"), [(0.74, 0), (0.75, 0), (0.78, 1), (0.8, 1)])
def test_a_leader_cut_to_three_quarters_is_not_found_and_not_false(kept: float, found: int) -> None:
    """The tolerance adds 5 cm of 2 m: 0.75 counts as 0.775, 0.78 as 0.805."""
    cut = leader(0.5, 0.5, 0.5 + 2 * kept)
    measures = branch_measures(grown(TRUNK, SUPPORT, cut), grown(TRUNK, SUPPORT, LEADER))
    assert measures["leaders_true"] == 1
    assert measures["leaders_found"] == found
    assert measures["false_leaders"] == 0


@pytest.mark.parametrize(("lower", "found"), [(0.60, 0), (0.67, 0), (0.68, 1), (0.75, 1)])
def test_a_leader_in_two_pieces_is_found_by_seven_tenths_of_it(lower: float, found: int) -> None:
    """A support that climbs beside the leader carries the upper piece."""
    cut = 0.5 + 2 * lower
    climb: Line = ("s", [(1, 0.5), (1, cut), (0.6, cut)])
    upper: Line = ("l", [(0.6, cut), (0.5, cut), (0.5, 2.5)])
    split = grown(TRUNK, SUPPORT, leader(0.5, 0.5, cut), climb, upper)
    measures = branch_measures(split, grown(TRUNK, SUPPORT, LEADER))
    assert measures["leaders_predicted"] == 2
    assert measures["leaders_found"] == found
    assert measures["false_leaders"] == 0


def test_a_side_branch_hangs_right_on_either_piece_of_a_leader() -> None:
    shoot: Line = ("b", [(0.5, 2), (0.2, 2)])
    climb: Line = ("s", [(1, 0.5), (1, 1.7), (0.6, 1.7)])
    upper: Line = ("l", [(0.6, 1.7), (0.5, 1.7), (0.5, 2), (0.5, 2.5)])
    split = grown(TRUNK, SUPPORT, leader(0.5, 0.5, 1.7), climb, upper, shoot)
    whole: Line = ("l", [(0.5, 0.5), (0.5, 2), (0.5, 2.5)])
    measures = branch_measures(split, grown(TRUNK, SUPPORT, whole, shoot))
    assert measures["leaders_found"] == 0
    assert measures["side_branches_parents_right"] == 1


@pytest.mark.parametrize(("length", "false"), [(0.19, 0), (0.2, 1), (1, 1)])
def test_a_leader_where_none_is_true_is_false_from_twenty_centimetres(
    length: float, false: int
) -> None:
    extra = leader(1, 0.5, 0.5 + length)
    measures = branch_measures(grown(TRUNK, SUPPORT, LEADER, extra), grown(TRUNK, SUPPORT, LEADER))
    assert measures["false_leaders"] == false
    assert measures["leaders_found"] == 1
    assert measures["leaders_predicted"] == 2


def test_a_false_side_branch_is_judged_from_eight_centimetres() -> None:
    truth = grown(TRUNK, SUPPORT, LEADER)
    for length, false in [(0.07, 0), (0.08, 1)]:
        extra: Line = ("b", [(0.5, 2.5), (0.5 - length, 2.5)])
        measures = branch_measures(grown(TRUNK, SUPPORT, LEADER, extra), truth)
        assert measures["false_side_branches"] == false
        assert math.isnan(measures["side_branches_found_share"])


@pytest.mark.parametrize(("kept", "found"), [(0.10, 0), (0.14, 0), (0.15, 1), (0.2, 1)])
def test_a_side_branch_is_found_by_half_of_it(kept: float, found: int) -> None:
    """Of 40 cm, with 5 cm of tolerance."""
    short: Line = ("b", [(0.5, 2.5), (0.5 - kept, 2.5)])
    whole: Line = ("b", [(0.5, 2.5), (0.1, 2.5)])
    measures = branch_measures(
        grown(TRUNK, SUPPORT, LEADER, short), grown(TRUNK, SUPPORT, LEADER, whole)
    )
    assert measures["side_branches_found"] == found


def test_a_true_branch_under_ten_centimetres_is_not_asked_for() -> None:
    for length, asked in [(0.09, 0), (0.1, 1)]:
        shoot: Line = ("b", [(0.5, 2.5), (0.5 - length, 2.5)])
        truth = grown(TRUNK, SUPPORT, LEADER, shoot)
        measures = branch_measures(truth, truth)
        assert measures["side_branches_true"] == asked
        assert measures["false_side_branches"] == 0


def test_one_predicted_leader_finds_one_true_one_at_most() -> None:
    two = grown(TRUNK, SUPPORT, LEADER, ("l", [(0.5, 0.5), (0.54, 0.6), (0.54, 2.4)]))
    one = grown(TRUNK, SUPPORT, LEADER)
    assert branch_measures(one, two)["leaders_true"] == 2
    assert branch_measures(one, two)["leaders_found"] == 1
    assert branch_measures(two, two)["leaders_found"] == 2
    assert branch_measures(two, one)["false_leaders"] == 0


def test_a_side_branch_on_the_wrong_leader_is_found_with_a_wrong_parent() -> None:
    one: Line = ("l", [(0.5, 0.5), (0.5, 1.5), (0.5, 2.5)])
    other: Line = ("l", [(1, 0.5), (1, 1.5), (1, 2.5)])
    leaders = TRUNK, SUPPORT, one, other
    measures = branch_measures(
        grown(*leaders, ("b", [(1, 1.5), (0.6, 1.5)])),
        grown(*leaders, ("b", [(0.5, 1.5), (0.9, 1.5)])),
    )
    assert measures["side_branches_found"] == 1
    assert measures["side_branches_parents_right"] == 0
    assert measures["leaders_parents_right"] == 2
    assert measures["parents_right_share"] == pytest.approx(2 / 3)


def test_the_side_of_the_parent_matters() -> None:
    both = TRUNK, SUPPORT, LEFT
    crossing: Line = ("l", [(-0.5, 0.5), (0.45, 0.55), (0.5, 0.6), (0.5, 2.5)])
    measures = branch_measures(grown(*both, crossing), grown(*both, LEADER))
    assert measures["leaders_found"] == 1
    assert measures["leaders_parents_right"] == 0


def test_a_leader_on_the_trunk_has_a_wrong_parent() -> None:
    truth = grown(TRUNK, ("s", [(0, 0.5), (0.05, 0.5), (1, 0.5)]), leader(0.05, 0.5, 2))
    wrong = grown(TRUNK, ("s", [(0, 0.5), (1, 0.5)]), ("l", [(0, 0.5), (0.05, 0.5), (0.05, 2)]))
    measures = branch_measures(wrong, truth)
    assert measures["leaders_found"] == 1
    assert measures["leaders_parents_right"] == 0


def test_a_support_the_wrong_way_is_not_right() -> None:
    same_way: Line = ("s", [(0, 0.5), (1, 0.3)])
    measures = branch_measures(grown(TRUNK, SUPPORT, same_way), grown(TRUNK, SUPPORT, LEFT))
    assert measures["supports_true"] == measures["supports_predicted"] == 2
    assert measures["supports_right"] == 1
    assert measures["supports_right_share"] == 0.5


def test_a_support_within_45_degrees_over_30_centimetres_is_right() -> None:
    truth = grown(TRUNK, SUPPORT)
    for rise, right in [(0.29, 1), (0.31, 0)]:
        measures = branch_measures(grown(TRUNK, ("s", [(0, 0.5), (0.3, 0.5 + rise)])), truth)
        assert measures["supports_right"] == right
    bent_late: Line = ("s", [(0, 0.5), (0.3, 0.5), (0.3, 2.5)])
    assert branch_measures(grown(TRUNK, bent_late), truth)["supports_right"] == 1


def test_a_shoot_on_the_support_hangs_right_on_the_support_only() -> None:
    shoot: Line = ("b", [(0.5, 0.5), (0.5, 0.2)])
    truth = grown(TRUNK, SUPPORT, LEADER, shoot)
    on_leader = grown(TRUNK, SUPPORT, ("l", [(0.5, 0.5), (0.5, 0.51), (0.5, 2.5)]))
    hung = grown(
        TRUNK,
        SUPPORT,
        ("l", [(0.5, 0.5), (0.5, 0.51), (0.5, 2.5)]),
        ("b", [(0.5, 0.51), (0.5, 0.2)]),
    )
    assert branch_measures(truth, truth)["side_branches_parents_right"] == 1
    assert branch_measures(hung, truth)["side_branches_found"] == 1
    assert branch_measures(hung, truth)["side_branches_parents_right"] == 0
    assert branch_measures(on_leader, truth)["side_branches_found"] == 0


def test_the_base_off_by_three_centimetres_is_three_centimetres_off() -> None:
    moved = tree().moved(RigidMotion(np.eye(3), np.array([0, 0.03, 0])))
    measures = branch_measures(moved, tree())
    assert measures["base_error"] == pytest.approx(0.03)
    assert measures["leaders_found"] == 3


STEM: Line = ("l", [(0.5, 0.5), (0.5, 1.5)])
SHORTER: Line = ("l", [(0.5, 1.5), (0.8, 1.8), (0.8, 2.3)])
LONGER: Line = ("l", [(0.5, 1.5), (0.2, 1.8), (0.2, 2.5)])
SPUR: Line = ("l", [(0.5, 1.5), (0.5, 1.59)])


@pytest.mark.parametrize("taken", [SHORTER, LONGER])
@pytest.mark.parametrize("order", [(SHORTER, LONGER), (LONGER, SHORTER)])
def test_a_double_leader_is_two_whichever_arm_the_stem_goes_on_with(
    taken: Line, order: tuple[Line, Line]
) -> None:
    """Predicted: the stem and one arm are one leader; the other arm hangs on a climbing support."""
    other = LONGER if taken is SHORTER else SHORTER
    truth = grown(TRUNK, SUPPORT, STEM, SPUR, *order, ("b", [(0.5, 1.5), (0.5, 1.2)]))
    climb: Line = ("s", [(1, 0.5), (1, 1.4), (0.52, 1.52)])
    arm: Line = ("l", [(0.52, 1.52), *other[1][1:]])
    measures = branch_measures(
        grown(TRUNK, SUPPORT, STEM, taken, climb, arm, ("b", [(0.5, 1.5), (0.5, 1.2)])), truth
    )
    assert measures["leaders_true"] == measures["leaders_found"] == 2
    assert measures["leaders_parents_right"] == 2
    assert measures["side_branches_parents_right"] == 1


def test_how_many_true_leaders_a_fork_has_does_not_depend_on_the_prediction() -> None:
    truth = grown(TRUNK, SUPPORT, STEM, SPUR, SHORTER, LONGER)
    for predicted in [(), (STEM,), (STEM, SPUR), (STEM, SHORTER), (STEM, LONGER, SPUR)]:
        measures = branch_measures(grown(TRUNK, SUPPORT, *predicted), truth)
        assert measures["leaders_true"] == 2


def test_a_forked_side_branch_is_two_on_one_leader() -> None:
    top: Line = ("b", [(0.5, 2.5), (0.3, 2.5), (0.2, 2.7)])
    arm: Line = ("b", [(0.3, 2.5), (0.2, 2.3)])
    truth = grown(TRUNK, SUPPORT, LEADER, top, arm)
    measures = branch_measures(truth, truth)
    assert measures["side_branches_true"] == measures["side_branches_found"] == 2
    assert measures["side_branches_parents_right"] == 2


def test_arms_without_another_tree_are_the_longest_first() -> None:
    forked = grown(TRUNK, SUPPORT, STEM, SPUR, SHORTER, LONGER)
    found = [branch.length for branch in arms(forked) if branch.label == Label.LEADER]
    slanted = 0.3 * math.sqrt(2)
    assert found == pytest.approx([1 + slanted + 0.7, 0.09, slanted + 0.5])


def test_arms_of_a_tree_without_forks_are_its_branches() -> None:
    ours, theirs = arms(tree()), branches(tree())
    assert [list(branch.rows) for branch in ours] == [list(branch.rows) for branch in theirs]
    labels = [branch.label.word for branch in ours]
    above = ["-" if p < 0 else labels[p] for p in parents(ours, len(tree()))]
    assert sorted(zip(labels, above, strict=True)) == [
        ("leader", "support"),
        ("leader", "support"),
        ("leader", "support"),
        ("side_branch", "leader"),
        ("support", "trunk"),
        ("support", "trunk"),
        ("trunk", "-"),
    ]
