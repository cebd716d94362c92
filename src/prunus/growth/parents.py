"""Parents and labels chosen together: branches hang where the grammar likes them best.

By turns the best labels of the tree are found, exactly, and, under these, a better place for every
branch among all nodes near its foot. Neither step ever makes the tree worth less, so it ends.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from prunus.field.votes import Threads
from prunus.growth.branches import Grown
from prunus.growth.graph import growth_costs
from prunus.growth.labels import FORK, LATER, TURN, Labelled, label_tree
from prunus.growth.shape import Tree
from prunus.model import Bools, Floats, Ints

REACH_M = 0.20
"""A branch may hang on any node so near to its foot."""
ROUNDS = 6
"""By then nothing changes."""
COST = 0.5
"""What a metre of the cost to grow over an edge is worth, in metres of doubtful labels."""
MORE = 0.02
"""A place is better by at least so much."""
LEAST_M = 0.05
"""Shorter branches stay where they are."""


def choose_parents(threads: Threads, grown: Grown) -> tuple[Grown, Labelled]:
    """The tree with better parents, and its labels."""
    roles = threads.role[grown.nodes]
    parent = grown.parent.copy()
    for _ in range(ROUNDS):
        tree = Tree(threads.xyz[grown.nodes], parent)
        told = label_tree(tree, roles)
        better = _better_parents(threads, grown.nodes, tree, told)
        if (better == parent).all():
            break
        parent = better
    tree = Tree(threads.xyz[grown.nodes], parent)
    return _in_order(grown.nodes, tree, label_tree(tree, roles))


def _in_order(nodes: Ints, tree: Tree, told: Labelled) -> tuple[Grown, Labelled]:
    order = np.array(tree.order)
    place = np.empty_like(order)
    place[order] = np.arange(len(order))
    parent = place[tree.parent[order]]
    parent[0] = -1
    labelled = Labelled(label=told.label[order], best=told.best[order], value=told.value)
    return Grown(nodes=nodes[order], parent=parent), labelled


def _better_parents(threads: Threads, nodes: Ints, tree: Tree, told: Labelled) -> Ints:
    """The parents (M,) with branches hung elsewhere; of those that are in each other's way one."""
    forks = np.flatnonzero([
        above > 0 and len(tree.children[above]) > 1 for above in tree.parent.tolist()
    ])  # fmt: skip
    forks = forks[tree.reach[forks] + tree.step[forks] >= LEAST_M]
    parent = tree.parent.copy()
    if len(forks) == 0:
        return parent
    near = cKDTree(tree.xyz).query_ball_point(tree.xyz[forks], REACH_M)
    row = np.repeat(forks, [len(some) for some in near])
    host = np.concatenate([np.array(some, np.int64) for some in near])
    kept = (host != row) & (host != 0)
    row, host = row[kept], host[kept]
    value = _value(threads, nodes, tree, told, row, host)
    now = _value(threads, nodes, tree, told, forks, tree.parent[forks])
    own = np.zeros(len(parent))
    own[forks] = now
    gain = value - own[row]
    moved = np.zeros(len(parent), np.bool_)
    for one in np.argsort(-gain, kind="stable").tolist():
        if gain[one] < MORE:
            break
        if _free(parent, moved, int(row[one]), int(host[one])):
            parent[row[one]] = host[one]
            moved[row[one]] = moved[host[one]] = True
    return parent


def _free(parent: Ints, moved: Bools, row: int, host: int) -> bool:
    """Whether neither was moved in this round, and the host is not above the row."""
    if moved[row] or moved[host]:
        return False
    while host >= 0 and host != row:
        host = int(parent[host])
    return host != row


def _value(
    threads: Threads, nodes: Ints, tree: Tree, told: Labelled, row: Ints, host: Ints
) -> Floats:
    """What it is worth (B,) if branches hang by their first row on hosts, whose labels stay."""
    label = told.label[host]
    as_other = np.array([
        max((told.best[one, later] - cost for later, cost in LATER[own]), default=-np.inf)
        for one, own in zip(row.tolist(), label.tolist(), strict=True)
    ])  # fmt: skip
    goes_on = _goes_on(tree, told, row, host)
    way = tree.xyz[row] - tree.xyz[host]
    onward = _unit(way + 0.08 * tree.head[row])
    turn = 1 - (onward * tree.tail[host]).sum(axis=1)
    as_same = told.best[row, label] - TURN * turn - np.where(goes_on, FORK[label], 0.0)
    outward = np.column_stack([nodes[host], nodes[row]])
    gap = np.linalg.norm(way, axis=1) > 0.04
    cost = growth_costs(threads, outward, gap)
    return np.asarray(np.maximum(as_other, as_same) - COST * cost)


def _goes_on(tree: Tree, told: Labelled, row: Ints, host: Ints) -> Bools:
    """Whether something else (B,) than the row goes on from the host with the host's label."""
    return np.array([
        any(told.label[child] == told.label[at] for child in tree.children[at] if child != one)
        for one, at in zip(row.tolist(), host.tolist(), strict=True)
    ])  # fmt: skip


def _unit(vectors: Floats) -> Floats:
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-9))
