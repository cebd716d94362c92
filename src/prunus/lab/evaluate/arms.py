"""Branches of a tree that may fork, as a given other tree would have them."""

from __future__ import annotations

from functools import partial

import numpy as np

from prunus.lab.evaluate.seen import COUNTS
from prunus.model import Floats, Ints, Label, Skeleton
from prunus.model.arrays import GRID
from prunus.model.branches import Branch, branch_of_rows


def arms(skeleton: Skeleton, shared: Floats | None = None) -> list[Branch]:
    """The branches of a skeleton, in the order in which they leave.

    Where a label forks, one arm carries the branch on and each other arm is a branch of its own.
    Which one is nobody's to say: it is the arm with which the branch shares most with a single
    branch of the other tree, `shared` (M, Q) being what each edge shares with each of those;
    between equals the longest. An arm shorter than `COUNTS` gives way to any longer, so that the
    number of branches of at least that length does not depend on the other tree.
    """
    following = _carried_on(skeleton, np.zeros((len(skeleton), 0)) if shared is None else shared)
    run_of: dict[int, list[int]] = {}
    runs: list[list[int]] = []
    for row in range(1, len(skeleton)):
        parent = int(skeleton.parent[row])
        if following[parent] == row:
            run_of[row] = run_of[parent]
        else:
            run_of[row] = [parent]
            runs.append(run_of[row])
        run_of[row].append(row)
    lengths = skeleton.lengths
    return [
        Branch(Label(skeleton.label[run[1]]), np.array(run), float(lengths[run[1:]].sum()))
        for run in runs
    ]


def parents(branches: list[Branch], rows: int) -> Ints:
    """The branch (B,) of another label from which each leaves; -1 for those from the base.

    An arm of a fork has the parent of what it forks from.
    """
    owner = branch_of_rows(branches, rows)
    parent = np.full(len(branches), -1)
    for number, branch in enumerate(branches):
        below = int(owner[branch.rows[0]])
        fork = below >= 0 and branches[below].label == branch.label
        parent[number] = parent[below] if fork else below
    return parent


def _carried_on(skeleton: Skeleton, shared: Floats) -> Ints:
    """For each row (M,) the row with which its branch goes on; -1 where it ends."""
    children = _same_label(skeleton)
    longest, most = skeleton.lengths.copy(), shared.copy()
    for row in range(len(skeleton) - 1, 0, -1):
        if children[row]:
            longest[row] += longest[children[row]].max()
            most[row] += most[children[row]].max(axis=0)
    so_far = shared.copy()
    following = np.full(len(skeleton), -1)

    def worth(row: int, arm: int) -> tuple[float, float, float]:
        shares = float((so_far[row] + most[arm]).max(initial=0.0))
        return min(float(longest[arm]), COUNTS - GRID), shares, float(longest[arm])

    for row, arms_here in enumerate(children):
        if arms_here:
            best = max(arms_here, key=partial(worth, row))
            so_far[best] += so_far[row]
            following[row] = best
    return following


def _same_label(skeleton: Skeleton) -> list[list[int]]:
    """For each row the rows that leave it with the label of its own edge; none at the base."""
    children: list[list[int]] = [[] for _ in range(len(skeleton))]
    for row in range(1, len(skeleton)):
        parent = int(skeleton.parent[row])
        if parent > 0 and skeleton.label[row] == skeleton.label[parent]:
            children[parent].append(row)
    return children
