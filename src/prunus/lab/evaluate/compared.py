"""Two trees against each other, branch by branch."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from prunus.geometry.near import within
from prunus.lab.evaluate.arms import arms, parents
from prunus.lab.evaluate.curves import TOLERANCE, sampled_rows
from prunus.model import Bools, Floats, Ints, Skeleton
from prunus.model.branches import Branch, branch_of_rows


@dataclass(frozen=True, eq=False, kw_only=True)
class Side:
    """One of the two trees, its branches (B), and what they share with those of the other (O).

    shared (B, O) counts the samples of a branch near one of the other; met (B,) those near any of
    the same label; samples (B,) all of them. parent (B,) is the branch from which each leaves.
    """

    skeleton: Skeleton
    branches: list[Branch]
    parent: Ints
    shared: Ints
    met: Ints
    samples: Ints


def compared(predicted: Skeleton, truth: Skeleton) -> tuple[Side, Side]:
    """Both trees against each other; forks of the true one as the predicted one has them."""
    ours = arms(predicted)
    near = _near(truth, predicted, ours)
    by_edge = np.zeros((len(truth), len(ours)))
    np.add.at(by_edge, sampled_rows(truth)[1], near)
    theirs = arms(truth, by_edge)
    back = _near(predicted, truth, theirs)
    return _side(predicted, ours, back), _side(truth, theirs, near)


def _near(tree: Skeleton, other: Skeleton, branches: list[Branch]) -> Bools:
    """Which samples of a tree are near which branch of the other, of the same label: (S, O)."""
    points, row = sampled_rows(tree)
    other_points, other_row = sampled_rows(other)
    start, members = within(other_points, points, TOLERANCE)
    sample = np.repeat(np.arange(len(points)), np.diff(start))
    same = tree.label[row[sample]] == other.label[other_row[members]]
    near = np.zeros((len(points), len(branches)), np.bool_)
    branch = branch_of_rows(branches, len(other))[other_row[members]]
    near[sample[same], branch[same]] = True
    return near


def _side(skeleton: Skeleton, branches: list[Branch], near: Bools) -> Side:
    branch = branch_of_rows(branches, len(skeleton))[sampled_rows(skeleton)[1]]
    shared = np.zeros((len(branches), near.shape[1]), np.int64)
    np.add.at(shared, branch, near)
    met = np.bincount(branch[near.any(axis=1)], minlength=len(branches))
    samples = np.bincount(branch, minlength=len(branches))
    hung = parents(branches, len(skeleton))
    return Side(
        skeleton=skeleton, branches=branches, parent=hung, shared=shared, met=met, samples=samples
    )


def overlap(ours: Side, theirs: Side) -> Ints:
    """(true, predicted): the samples that two branches have near each other, of both."""
    return np.asarray(theirs.shared + ours.shared.T)


def one_to_one(score: Floats | Ints) -> list[tuple[int, int]]:
    """Pairs of a row and a column, the best first, none used twice; a score of 0 is no pair."""
    left, pairs = score.copy(), []
    while left.size and left.max() > 0:
        row, column = divmod(int(left.argmax()), left.shape[1])
        pairs.append((row, column))
        left[row], left[:, column] = 0, 0
    return pairs
