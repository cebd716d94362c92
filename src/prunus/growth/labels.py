"""Labels of a grown tree: the best under the grammar, exact by dynamic programming over the tree.

Every edge has a probability of each role. What a labelled tree is worth is the sum of the logs of
those, by length, less what changes of label, forks of one label and turns within one cost.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from prunus.growth.shape import FORKS, Tree
from prunus.model import Bools, Floats, Ints, Label
from prunus.model.role import label_chances

LEAST = 0.02
"""A probability is never taken for less: one voxel does not forbid a label."""
CHANGE = {
    (Label.TRUNK, Label.SUPPORT): 0.15,
    (Label.TRUNK, Label.LEADER): 0.60,
    (Label.SUPPORT, Label.LEADER): 0.15,
    (Label.LEADER, Label.SIDE_BRANCH): 0.12,
    (Label.SUPPORT, Label.SIDE_BRANCH): 0.20,
    (Label.TRUNK, Label.SIDE_BRANCH): 0.30,
}
"""What a change of label costs, in metres of wood whose label is off by a factor e."""
FORK = np.array([9.0, 1.0, 0.5, 0.1])
"""What it costs if a second branch of the same label goes on from one (no Y of one label)."""
TURN = 0.3
"""What it costs if one label turns at a fork, for each unit of one less the cosine."""
NEVER = -1e9
"""What is not allowed is worth so little."""

CHANGES = np.full((len(Label), len(Label)), -NEVER)
"""What it costs (4, 4) to change from one label to another."""
for _pair, _cost in CHANGE.items():
    CHANGES[_pair] = _cost


@dataclass(frozen=True, eq=False, kw_only=True)
class Labelled:
    """The labels (M,) of the edges into the rows of a tree, and the value of all together.

    best (M, 4): what each edge and all above it is worth under each of its labels; other (M, 4):
    under the best label that may leave each of the labels.
    """

    label: Ints
    best: Floats
    other: Floats
    value: float


def label_tree(tree: Tree, roles: Floats) -> Labelled:
    """The best labels of a tree; roles (M, 6) are the probabilities at its rows.

    Row 0, the foot, has the label of the first edge.
    """
    best = _worth(roles, tree.step)
    other, later = np.empty_like(best), np.empty(best.shape, np.int64)
    goes_on = np.zeros(best.shape, np.bool_)
    for rows in tree.levels:  # from the tips down: all above them is known
        best[rows] += _above(tree, best, other, goes_on, rows)
        changed = best[rows, None, :] - CHANGES
        later[rows] = changed.argmax(axis=2)
        other[rows] = changed.max(axis=2)
    label = _told(tree, later, goes_on)
    value = float(best[tree.children[0], label[tree.children[0]]].sum())
    return Labelled(label=label, best=best, other=other, value=value)


def _worth(roles: Floats, step: Floats) -> Floats:
    return np.asarray(step[:, None] * np.log(label_chances(roles) + LEAST))


def _above(tree: Tree, best: Floats, other: Floats, goes_on: Bools, rows: Ints) -> Floats:
    """What is above the edges into some rows is worth (R, 4) under each of their labels.

    `goes_on` (M, 4) is set for what hangs on them: whether it keeps the label of its parent.
    """
    above = np.zeros((len(rows), len(Label)))
    single = tree.only_child[rows]
    one, child = np.flatnonzero(single >= 0), single[single >= 0]
    goes_on[child] = best[child] >= other[child]
    above[one] = np.maximum(best[child], other[child])
    for place in np.flatnonzero(single == FORKS):
        below = tree.children[rows[place]]
        gain = best[below] - TURN * tree.turn[below][:, None] - other[below]
        # One may go on with the label for nothing, each other one for the price of a fork.
        gain -= np.where(gain == gain.max(axis=0), 0.0, FORK)
        goes_on[below] = gain > 0
        above[place] = (other[below] + np.maximum(gain, 0.0)).sum(axis=0)
    return above


def _told(tree: Tree, later: Ints, goes_on: Bools) -> Ints:
    """The labels, from the foot upward."""
    label = np.zeros(len(tree.parent), np.int64)
    for rows in tree.levels[::-1]:
        own = label[tree.parent[rows]]
        told = np.where(goes_on[rows, own], own, later[rows, own])
        label[rows] = np.where(tree.parent[rows] == 0, int(Label.TRUNK), told)
    return label
