"""Labels of a grown tree: the best under the grammar, exact by dynamic programming over the tree.

Every edge has a probability of each role. What a labelled tree is worth is the sum of the logs of
those, by length, less what changes of label, forks of one label and turns within one cost.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from prunus.growth.shape import Tree
from prunus.model import Floats, Ints, Label, Role

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

LATER = [
    [(int(later), cost) for (earlier, later), cost in CHANGE.items() if earlier == label]
    for label in Label
]


@dataclass(frozen=True, eq=False, kw_only=True)
class Labelled:
    """The labels (M,) of the edges into the rows of a tree, and the value of all together.

    best (M, 4): what is above each edge, itself included, is worth under each of its labels.
    """

    label: Ints
    best: Floats
    value: float


def label_tree(tree: Tree, roles: Floats) -> Labelled:
    """The best labels of a tree; roles (M, 6) are the probabilities at its rows.

    Row 0, the foot, has the label of the first edge.
    """
    worth = _worth(roles, tree.step).tolist()
    best = np.zeros((len(tree.parent), len(Label))).tolist()
    chosen: list[list[list[int]]] = [[] for _ in tree.parent]
    for row in reversed(tree.order[1:]):
        below = tree.children[row]
        turns = [TURN * tree.turn[child] for child in below] if len(below) > 1 else [0.0]
        for label in range(len(Label)):
            value, picks = _above(best, below, turns, label)
            best[row][label] = worth[row][label] + value
            chosen[row].append(picks)
    told = _told(tree, chosen)
    value = float(sum(best[child][told[child]] for child in tree.children[0]))
    return Labelled(label=told, best=np.array(best), value=value)


def chances(roles: Floats) -> Floats:
    """The probability (M, 4) of each label, of roles (M, 6); a spur counts as side branch."""
    chance = roles[:, : len(Label)].copy()
    chance[:, Label.SIDE_BRANCH] += roles[:, Role.SPUR_OR_SHOOT]
    return np.asarray(chance / np.maximum(chance.sum(axis=1, keepdims=True), 1e-9))


def _worth(roles: Floats, step: Floats) -> Floats:
    return np.asarray(step[:, None] * np.log(chances(roles) + LEAST))


def _above(
    best: list[list[float]], children: list[int], turns: list[float], label: int
) -> tuple[float, list[int]]:
    """The best that the children of an edge with that label are worth, and their labels."""
    total, picks, gains = 0.0, list[int](), list[float]()
    for child, turn in zip(children, turns, strict=bool(children)):
        options = [(best[child][later] - cost, later) for later, cost in LATER[label]]
        value, other = max(options, default=(NEVER, label))
        total += value
        picks.append(other)
        gains.append(best[child][label] - turn - value)
    order = sorted(range(len(children)), key=lambda one: -gains[one])
    for place, one in enumerate(order):
        gain = gains[one] - (FORK[label] if place else 0.0)
        if gain > 0:
            total += gain
            picks[one] = label
    return total, picks


def _told(tree: Tree, chosen: list[list[list[int]]]) -> Ints:
    """The labels, from the foot upward."""
    label = np.zeros(len(tree.parent), np.int64)
    for row in tree.order:
        below = tree.children[row]
        picks = [int(Label.TRUNK)] * len(below) if row == 0 else chosen[row][label[row]]
        for child, pick in zip(below, picks, strict=True):
            label[child] = pick
    return label
