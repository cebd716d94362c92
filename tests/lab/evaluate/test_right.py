"""Which branches are right, on drawn trees."""

import numpy as np

from prunus.lab.evaluate.right import right_branches, right_edges, well_placed_branches
from prunus.model import Label, Skeleton
from prunus.model.branches import branches
from tests.drawn import tree

CROSSED = """
l   lbbb
l   lb l
l   l  l
ssstssss
   t
   o
"""
"""The tree with the top of its right leader hung on the middle one, as a side branch."""


def wrong(predicted: Skeleton, truth: Skeleton) -> list[Label]:
    """The labels of the branches that are not right."""
    right = right_branches(predicted, truth)
    return [one.label for one, fine in zip(branches(predicted), right, strict=True) if not fine]


def test_of_a_tree_all_is_right() -> None:
    assert right_branches(tree(), tree()).all()


def test_a_branch_where_there_is_none_is_wrong_and_the_others_stay_right() -> None:
    assert wrong(tree(CROSSED), tree()) == [Label.SIDE_BRANCH]


def test_a_wrong_label_is_wrong() -> None:
    label = tree().label.copy()
    label[label == Label.SIDE_BRANCH] = Label.LEADER
    other = Skeleton.build(tree().xyz, tree().parent, label)
    assert wrong(other, tree()) == [Label.LEADER]


def test_a_branch_that_hangs_on_the_wrong_one_is_wrong() -> None:
    truth = tree()
    parent = truth.parent.copy()
    shoot = int(np.flatnonzero(truth.label == Label.SIDE_BRANCH)[0])
    right_leader = np.flatnonzero((truth.label == Label.LEADER) & (truth.xyz[:, 0] > 0.65))
    parent[shoot] = right_leader[0]
    order = np.argsort(np.where(np.arange(len(truth)) == shoot, len(truth), np.arange(len(truth))))
    place = np.argsort(order)
    moved = np.where(parent < 0, -1, place[np.maximum(parent, 0)])
    other = Skeleton.build(truth.xyz[order], moved[order], truth.label[order])
    assert wrong(other, truth) == [Label.SIDE_BRANCH]


def test_of_two_along_one_true_branch_one_is_right() -> None:
    truth = tree()
    leader = max(branches(truth, Label.LEADER), key=lambda one: one.length).rows
    again = np.arange(len(leader) - 1) + len(truth)
    parent = [*truth.parent, leader[0], *again[:-1]]
    beside = truth.xyz[leader[1:]] + [0.02, 0, 0]
    label = [*truth.label, *truth.label[leader[1:]]]
    double = Skeleton.build(np.concatenate([truth.xyz, beside]), parent, label)
    assert wrong(double, truth) == [Label.LEADER]


def test_an_edge_is_right_on_true_wood_of_its_label() -> None:
    truth = tree()
    assert right_edges(truth, truth).all()
    label = truth.label.copy()
    label[label == Label.SIDE_BRANCH] = Label.LEADER
    other = Skeleton.build(truth.xyz, truth.parent, label)
    assert (right_edges(other, truth, labelled=False)).all()
    assert right_edges(other, truth).sum() < len(truth) - 1


def test_where_labels_are_none_a_branch_is_right_that_lies_on_wood() -> None:
    truth, crossed = tree(), tree(CROSSED)
    assert well_placed_branches(truth, truth).all()
    placed = well_placed_branches(crossed, truth)
    assert [one.label for one, fine in zip(branches(crossed), placed, strict=True)
            if not fine] == [Label.SIDE_BRANCH]  # fmt: skip
