"""The edit ratio by length, on drawn trees with metres by hand."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import linear_sum_assignment

from prunus.lab.evaluate.along import asked_of, pieces_of
from prunus.lab.evaluate.by_length import LengthEdits, _paired, edits_by_length, geometry_f1
from prunus.model import Label, RigidMotion, Skeleton
from tests.drawn import TREE, tree
from tests.lab.evaluate.test_found import LEADER, LEFT, SUPPORT, TRUNK, grown, leader

CENTIMETRE = 0.0101
"""Places between pieces may go either way, a centimetre each."""


def compared(predicted: Skeleton, truth: Skeleton) -> LengthEdits:
    """All of the true tree is asked for."""
    return edits_by_length(predicted, truth, np.ones(len(truth), np.bool_))


def relabelled(skeleton: Skeleton, labels: dict[Label, Label]) -> Skeleton:
    new = [labels.get(Label(label), Label(label)) for label in skeleton.label]
    return replace(skeleton, label=np.array(new, np.int8))


def moved(skeleton: Skeleton, x: float, y: float = 0.0) -> Skeleton:
    return skeleton.moved(RigidMotion(np.eye(3), np.array([x, y, 0.0])))


def test_a_tree_needs_no_edits_to_be_itself() -> None:
    found = compared(tree(), tree())
    assert found.ratio == found.geometry_ratio == 0
    assert found.label_accuracy == 1
    assert list(found.label_ratios.values()) == [0, 0, 0, 0]
    assert found.length == pytest.approx(float(tree().lengths.sum()))


def test_a_leader_that_is_not_there_is_missing_and_nothing_else() -> None:
    truth = grown(TRUNK, SUPPORT, LEFT, LEADER)
    found = compared(grown(TRUNK, SUPPORT, LEFT), truth)
    assert (found.wrong, found.mislabelled) == (0, 0)
    assert found.missing == pytest.approx(2.0)
    assert found.ratio == found.geometry_ratio == pytest.approx(2.0 / 4.5)
    assert found.label_ratios[Label.LEADER] == 1
    assert found.label_ratios[Label.SUPPORT] == 0


def test_a_leader_too_many_is_wrong_and_nothing_else() -> None:
    more = grown(TRUNK, SUPPORT, LEFT, LEADER, leader(-1, 0.5, 1.5))
    found = compared(more, grown(TRUNK, SUPPORT, LEFT, LEADER))
    assert (found.missing, found.mislabelled) == (0, 0)
    assert found.wrong == pytest.approx(1.0)
    assert found.label_ratios[Label.LEADER] == pytest.approx(1.0 / 2.0)


def test_of_two_strands_along_one_leader_the_second_is_wrong() -> None:
    beside = ("l", [(0.5, 0.5), (0.52, 0.55), (0.52, 2.45)])
    found = compared(grown(TRUNK, SUPPORT, LEADER, beside), grown(TRUNK, SUPPORT, LEADER))
    assert found.wrong == pytest.approx(1.95, abs=CENTIMETRE)
    assert (found.missing, found.mislabelled) == (0, 0)


def test_of_two_strands_under_two_labels_the_right_one_is_kept() -> None:
    beside = ("b", [(0.5, 0.5), (0.52, 0.55), (0.52, 2.45)])
    found = compared(grown(TRUNK, SUPPORT, beside, LEADER), grown(TRUNK, SUPPORT, LEADER))
    assert (found.missing, found.mislabelled) == (0, 0)
    assert found.label_ratios[Label.LEADER] == 0
    assert math.isnan(found.label_ratios[Label.SIDE_BRANCH])
    assert found.differing[Label.SIDE_BRANCH] == pytest.approx(1.95, abs=CENTIMETRE)


def test_labels_that_are_swapped_count_once_and_only_where_labels_count() -> None:
    swapped = {Label.LEADER: Label.SIDE_BRANCH, Label.SIDE_BRANCH: Label.LEADER}
    found = compared(relabelled(tree(), swapped), tree())
    metres = float(tree().lengths[tree().label >= Label.LEADER].sum())
    assert found.mislabelled == pytest.approx(metres)
    assert (found.wrong, found.missing, found.geometry_ratio) == (0, 0, 0)
    assert found.label_accuracy == pytest.approx(1 - metres / found.length)


@pytest.mark.parametrize("step", [1, 2, 3])
def test_a_tree_with_every_label_wrong_is_all_mislabelled(step: int) -> None:
    truth = grown(TRUNK, SUPPORT, LEADER, ("b", [(0.5, 2.5), (0.9, 2.5)]))
    wrong = {label: Label((label + step) % len(Label)) for label in Label}
    found = compared(relabelled(truth, wrong), truth)
    assert found.ratio == 1
    assert (found.geometry_ratio, found.label_accuracy) == (0, 0)


def test_a_tool_without_labels_has_a_geometry_ratio() -> None:
    truth = grown(TRUNK, SUPPORT, LEADER)
    bare = relabelled(truth, dict.fromkeys(Label, Label.TRUNK))
    assert compared(bare, truth).geometry_ratio == 0
    assert compared(bare, truth).ratio == pytest.approx(3.0 / 3.5)


@pytest.mark.parametrize("hole", [0.3, 0.7, 1.2])
def test_a_hole_is_missing_and_the_bridge_to_what_is_beyond_it_is_wrong(hole: float) -> None:
    height = 0.5 + hole
    through = ("l", [(0.5, 0.5), (0.5, height), (0.5, 2.5)])
    truth = grown(TRUNK, SUPPORT, through, leader(1, 0.5, 2.5))
    bridge = ("l", [(0.5, height), (1, height), (1, 2.5)])
    found = compared(grown(TRUNK, SUPPORT, through, bridge), truth)
    assert found.missing == pytest.approx(hole, abs=4 * CENTIMETRE)
    assert found.wrong == pytest.approx(0.5, abs=4 * CENTIMETRE)
    assert found.mislabelled == 0


def test_a_leader_that_ends_early_is_missing_beyond_its_end() -> None:
    whole = grown(TRUNK, SUPPORT, LEADER)
    short = compared(grown(TRUNK, SUPPORT, leader(0.5, 0.5, 2.2)), whole)
    assert short.missing == pytest.approx(0.3)
    assert short.wrong == 0


@pytest.mark.parametrize(("aside", "right"), [(0.059, True), (0.061, False)])
def test_wood_is_right_within_six_centimetres(aside: float, right: bool) -> None:
    found = compared(moved(grown(TRUNK, SUPPORT, LEADER), 0, aside), grown(TRUNK, SUPPORT, LEADER))
    assert (found.ratio == 0) == right
    assert right or found.wrong == found.missing == pytest.approx(3.5)


@pytest.mark.parametrize(("degrees", "right"), [(40, True), (50, False)])
def test_wood_that_crosses_the_true_wood_steeply_is_wrong(degrees: float, right: bool) -> None:
    truth = Skeleton.build([[-1, 0, 0], [1, 0, 0]], [-1, 0], [0, 0])
    way = 0.08 * np.array([np.cos(np.radians(degrees)), 0, np.sin(np.radians(degrees))])
    found = compared(Skeleton.build([-way / 2, way / 2], [-1, 0], [0, 0]), truth)
    assert found.wrong == pytest.approx(0.0 if right else 0.08)
    assert found.missing == pytest.approx(2.0 - (0.08 if right else 0.0))


def test_a_skeleton_that_runs_from_the_tip_to_the_foot_is_none_the_worse() -> None:
    down = Skeleton.build([[0, 0, 1], [0, 0, 0]], [-1, 0], [0, 0])
    assert compared(down, Skeleton.build([[0, 0, 0], [0, 0, 1]], [-1, 0], [0, 0])).ratio == 0


@pytest.mark.parametrize("shift", [-0.2, -0.09, 0.09, 0.2])
def test_a_label_may_change_ten_centimetres_off(shift: float) -> None:
    def changing(at: float) -> Skeleton:
        return grown(("t", [(0, 0), (0, at)]), ("s", [(0, at), (0, 2)]))

    found = compared(changing(1 + shift), changing(1))
    if abs(shift) < 0.1:
        assert found.ratio == 0
    else:
        assert 0.01 <= found.mislabelled <= abs(shift)
    assert found.geometry_ratio == 0


def test_near_a_change_there_is_no_leeway_for_a_tree_that_does_not_change() -> None:
    truth = grown(TRUNK, ("s", [(0, 0.5), (0, 1.0)]), ("l", [(0, 1.0), (0, 1.1)]))
    found = compared(relabelled(truth, {Label.LEADER: Label.SUPPORT}), truth)
    assert found.mislabelled == pytest.approx(0.10)
    assert found.label_ratios[Label.LEADER] == 1


def test_truth_is_asked_for_from_its_foot_to_the_last_place_shown() -> None:
    truth = tree("l\nl\nl\nl\nl\nl\ns\nt\no")
    counts = np.ones(len(truth), np.bool_)
    counts[[3, 4, -1]] = False
    asked, rest = asked_of(truth, counts)
    assert len(asked) == 70
    assert len(rest) == 10
    found = edits_by_length(truth, truth, counts)
    assert found.missing == 0
    assert found.wrong == found.unasked == pytest.approx(0.10)


def test_branches_that_do_not_count_are_not_missed() -> None:
    truth = tree()
    counts = truth.label != Label.SIDE_BRANCH
    found = edits_by_length(truth.part(counts), truth, counts)
    assert found.ratio == 0
    assert math.isnan(found.label_ratios[Label.SIDE_BRANCH])


def test_a_base_alone_has_all_of_the_tree_missing() -> None:
    found = compared(tree("o"), tree())
    assert found.ratio == found.geometry_ratio == 1
    assert math.isnan(found.label_accuracy)
    assert geometry_f1(tree("o"), tree(), np.ones(len(tree()), np.bool_), 0.05) == 0


def test_where_nothing_is_asked_for_there_is_no_ratio() -> None:
    found = edits_by_length(tree(), tree(), np.zeros(len(tree()), np.bool_))
    assert math.isnan(found.ratio)


def test_a_centimetre_more_or_less_between_nodes_does_not_change_the_length() -> None:
    coarse = Skeleton.build([[0, 0, 0], [0, 0, 1]], [-1, 0], [0, 0])
    for steps in (60, 77, 140, 400):
        z = np.linspace(0, 1, steps + 1)
        xyz = np.column_stack([0 * z, 0 * z, z])
        fine = Skeleton.build(xyz, np.arange(-1, steps), np.zeros(steps + 1, np.int8))
        assert len(pieces_of(fine)) == len(pieces_of(coarse)) == 100
        assert compared(fine, coarse).ratio == 0


@pytest.mark.parametrize(("tolerance", "f1"), [(0.02, 0.0), (0.05, 1.0)])
def test_a_chain_along_the_bark_shows_at_two_centimetres(tolerance: float, f1: float) -> None:
    counts = np.ones(len(tree(TREE)), np.bool_)
    assert geometry_f1(moved(tree(), 0, 0.03), tree(), counts, tolerance) == f1


@pytest.mark.parametrize("seed", range(5))
def test_as_many_pieces_are_paired_as_can_be_and_each_once(seed: int) -> None:
    rng = np.random.default_rng(seed)
    near = rng.random((30, 25)) < 0.06
    partner = _paired(np.stack(np.nonzero(near)), *near.shape)
    paired = np.flatnonzero(partner >= 0)
    assert near[paired, partner[paired]].all()
    assert len(np.unique(partner[paired])) == len(paired)
    assert len(paired) == near[linear_sum_assignment(near, maximize=True)].sum()
