"""Branches: contiguous runs of edges with one label."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from prunus.model import Ints, Label, Skeleton


@dataclass(frozen=True, eq=False)
class Branch:
    """A run of edges of one label: rows (R,) of the skeleton, from where it leaves its parent."""

    label: Label
    rows: Ints
    length: float


def branches(skeleton: Skeleton, label: Label | None = None) -> list[Branch]:
    """All branches, or those of one label, in the order in which they leave.

    Where a label forks (only hand-made skeletons do), each arm after the first is its own branch.
    """
    taken: dict[int, list[int]] = {}
    runs: list[list[int]] = []
    for row in range(1, len(skeleton)):
        parent = int(skeleton.parent[row])
        run = taken.get(parent)
        if run is not None and run[-1] == parent and skeleton.label[row] == skeleton.label[parent]:
            run.append(row)
        else:
            run = [parent, row]
            runs.append(run)
        taken[row] = run
    lengths = skeleton.lengths
    found = [
        Branch(Label(skeleton.label[run[1]]), np.array(run), float(lengths[run[1:]].sum()))
        for run in runs
    ]
    return [branch for branch in found if label is None or branch.label == label]


def branch_of_rows(branches: list[Branch], rows: int) -> Ints:
    """The branch (M,) to which the edge that ends in each row belongs; -1 at row 0."""
    owner = np.full(rows, -1)
    for number, branch in enumerate(branches):
        owner[branch.rows[1:]] = number
    return owner


def orders(branches: list[Branch], rows: int) -> Ints:
    """How many branches (B,) carry each, one on the other: 0 for what leaves the base."""
    owner = branch_of_rows(branches, rows)
    order = np.zeros(len(branches), np.int64)
    for number, branch in enumerate(branches):
        carrier = owner[branch.rows[0]]
        order[number] = 0 if carrier < 0 else order[carrier] + 1
    return order


def lengths_by_label(skeleton: Skeleton) -> dict[Label, float]:
    """Metres of each label."""
    lengths = skeleton.lengths
    return {label: float(lengths[skeleton.edges_with(label)].sum()) for label in Label}
