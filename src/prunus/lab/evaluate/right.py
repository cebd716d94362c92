"""Which parts of a predicted skeleton are right: what a confidence in them should foretell."""

from __future__ import annotations

import numpy as np

from prunus.lab.evaluate.along import pieces_of
from prunus.lab.evaluate.by_length import on_true_wood
from prunus.lab.evaluate.compared import Side, compared, one_to_one, overlap
from prunus.lab.evaluate.curves import SPACING
from prunus.lab.evaluate.found import stands_for
from prunus.model import Bools, Skeleton
from prunus.model.branches import branches

MOSTLY = 0.7
"""So much of a right branch lies on one true branch of its label."""


def right_branches(predicted: Skeleton, truth: Skeleton) -> Bools:
    """Whether each branch (B,) of a predicted skeleton is right, in the order of its branches.

    It is right where `MOSTLY` of it lies within 5 cm of one true branch of its label, for which no
    other predicted one stands better, and it leaves the branch that stands for that one's parent.
    Both skeletons in one frame, and no label of the predicted one forks.
    """
    ours, theirs = compared(predicted, truth)
    both = overlap(ours, theirs)
    right = np.zeros(len(ours.branches), np.bool_)
    for true, branch in one_to_one(both):
        along = ours.shared[branch, true] >= MOSTLY * ours.samples[branch]
        right[branch] = along and _hangs_right(ours, theirs, branch, true)
    return right


def _hangs_right(ours: Side, theirs: Side, branch: int, true: int) -> bool:
    parent = stands_for(overlap(ours, theirs), int(ours.parent[branch]))
    return bool(parent == theirs.parent[true])


def right_edges(predicted: Skeleton, truth: Skeleton, labelled: bool = True) -> Bools:
    """Whether each edge (M - 1,) of a predicted skeleton lies on true wood of its label.

    By the pieces of the edit ratio by length: within 6 cm of wood that runs the same way, and that
    no other branch lies nearer to. Not `labelled`: of any label, for trees whose truth has none.
    """
    found = branches(predicted)
    count = np.array([round(one.length / SPACING) for one in found])
    number = np.repeat(np.arange(len(found)), count)
    piece = on_true_wood(pieces_of(predicted), number, truth, labelled)
    right, start = np.zeros(len(predicted) - 1, np.bool_), count.cumsum() - count
    for first, size, one in zip(start.tolist(), count.tolist(), found, strict=True):
        if size == 0:
            continue
        length = predicted.lengths[one.rows[1:]]
        at = ((length.cumsum() - length / 2) / one.length * size).astype(np.int64)
        right[one.rows[1:] - 1] = piece[first + np.minimum(at, size - 1)]
    return right


def well_placed_branches(predicted: Skeleton, truth: Skeleton) -> Bools:
    """Whether each branch (B,) is right where the truth has no labels: `MOSTLY` on true wood."""
    right = np.append(False, right_edges(predicted, truth, labelled=False))
    return np.array([
        right[one.rows[1:]] @ predicted.lengths[one.rows[1:]] >= MOSTLY * one.length
        for one in branches(predicted)
    ], np.bool_)  # fmt: skip
