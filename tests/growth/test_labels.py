"""The labels of a tree are the best that there are, and better parents never make it worth less."""

import itertools

import numpy as np
import pytest

from prunus.growth.branches import Grown
from prunus.growth.labels import CHANGES, FORK, TURN, label_tree
from prunus.growth.parents import choose_parents
from prunus.growth.shape import Tree
from prunus.model import Floats, Ints, Label
from prunus.model.role import label_chances
from tests.growth.drawn import TEXTBOOK, threads_of


def random_tree(seed: int, rows: int) -> tuple[Tree, Floats]:
    rng = np.random.default_rng(seed)
    parent = np.array([-1] + [rng.integers(max(0, row - 3), row) for row in range(1, rows)])
    xyz = np.zeros((rows, 3))
    for row in range(1, rows):
        xyz[row] = xyz[parent[row]] + rng.normal(0, 0.2, 3)
    return Tree(xyz, parent), rng.dirichlet(np.ones(6) * 0.4, rows)


def value(tree: Tree, roles: Floats, label: Ints) -> float:
    """What a labelled tree is worth, added up edge by edge; -inf where it is not allowed."""
    worth = tree.step[:, None] * np.log(label_chances(roles) + 0.02)
    total = 0.0
    for row, below in enumerate(tree.children):
        same = []
        for child in below:
            if row == 0:
                if label[child] != Label.TRUNK:
                    return -np.inf
            elif label[child] == label[row]:
                same.append(TURN * tree.turn[child] if len(below) > 1 else 0.0)
            else:
                total -= CHANGES[label[row], label[child]]
            total += worth[child, label[child]]
        total -= sum(same) + FORK[label[row]] * max(0, len(same) - 1)
    return total


@pytest.mark.parametrize("seed", range(12))
def test_no_other_labels_are_worth_more(seed: int) -> None:
    tree, roles = random_tree(seed, 7)
    told = label_tree(tree, roles)
    every = [np.array([0, *some]) for some in itertools.product(range(4), repeat=6)]
    best = max(value(tree, roles, label) for label in every)
    assert value(tree, roles, told.label) == pytest.approx(best, abs=1e-9)
    assert told.value == pytest.approx(best, abs=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_choosing_parents_keeps_every_node_and_one_root(seed: int) -> None:
    threads = threads_of(TEXTBOOK, seed)
    rng = np.random.default_rng(seed)
    rows = len(threads)
    near = np.array([-1] + [rng.integers(max(0, row - 4), row) for row in range(1, rows)])
    grown = Grown(nodes=np.arange(rows), parent=near)
    before = label_tree(Tree(threads.xyz, near), threads.role).value
    after, told = choose_parents(threads, grown)
    assert sorted(after.nodes.tolist()) == list(range(rows))
    assert (after.parent[1:] < np.arange(1, rows)).all()
    assert told.value > before
