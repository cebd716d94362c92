"""Which branches of a predicted skeleton are right: what a confidence in them should foretell."""

from __future__ import annotations

import numpy as np

from prunus.evaluate.compared import Side, compared, one_to_one, overlap
from prunus.evaluate.found import stands_for
from prunus.model import Bools, Skeleton

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
