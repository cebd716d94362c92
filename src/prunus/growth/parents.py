"""Parents and labels chosen together: branches hang where the grammar likes them best.

By turns the best labels of the tree are found, exactly, and, under these, a better place for every
branch among all nodes near its foot: a hill climb. Moves of one turn are weighed each for itself.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from prunus.field.votes import Threads
from prunus.growth.branches import COVER_M, THIN_M, Grown
from prunus.growth.graph import NEAR_M, growth_costs
from prunus.growth.labels import FORK, TURN, Labelled, label_tree
from prunus.growth.shape import TIP, Tree
from prunus.model import Bools, Floats, Ints

REACH_M = 0.20
"""A branch may hang on any node so near to its foot,"""
END_REACH_M = 0.40
"""and on an end that is so near: what goes on may be hidden."""
ROUNDS = 6
"""So many turns at most."""
COST = 0.7
"""What a metre of the cost to grow over an edge is worth, in metres of doubtful labels."""
MORE = 0.02
"""A place is better by at least so much."""
BETWEEN = 4
"""A way is looked at in so many places whether there is wood; none is as near to one end as to the
other, where rounding would decide."""
LEAST_M = 0.05
"""Shorter branches stay where they are."""


class Straight:
    """Straight ways between rows xyz (M, 3) of a tree; whether each leaves wood is remembered."""

    def __init__(self, threads: Threads, xyz: Floats) -> None:
        self.threads, self.xyz = threads, xyz
        self._known = np.zeros(0, np.int64)
        self._leaves = np.zeros(0, np.bool_)

    def leave_wood(self, row: Ints, host: Ints) -> Bools:
        """Whether the ways (B,) from hosts to rows go through the open.

        Each way once, in the order of the rows, and of the hosts of one row.
        """
        way = row * len(self.xyz) + host
        place = np.searchsorted(self._known, way)
        known = np.append(self._known, -1)[place] == way
        new, at = way[~known], place[~known]
        start, end = (self.xyz[rows] for rows in (new % len(self.xyz), new // len(self.xyz)))
        self._leaves = np.insert(self._leaves, at, _leaves_wood(self.threads, start, end))
        self._known = np.insert(self._known, at, new)
        return np.asarray(self._leaves[np.searchsorted(self._known, way)])


def choose_parents(threads: Threads, grown: Grown) -> tuple[Grown, Labelled]:
    """The tree with better parents, and its labels."""
    roles = threads.role[grown.nodes]
    parent = grown.parent.copy()
    ways = Straight(threads, threads.xyz[grown.nodes])
    for left in reversed(range(ROUNDS + 1)):
        tree = Tree(threads.xyz[grown.nodes], parent)
        told = label_tree(tree, roles)
        better = _better_parents(ways, grown.nodes, tree, told) if left else parent
        if (better == parent).all():
            break
        parent = better
    return _in_order(grown.nodes, tree, told)


def keep_parents(threads: Threads, grown: Grown) -> tuple[Grown, Labelled]:
    """The tree as it grew, and its labels: in place of `choose_parents`."""
    tree = Tree(threads.xyz[grown.nodes], grown.parent)
    return _in_order(grown.nodes, tree, label_tree(tree, threads.role[grown.nodes]))


def _in_order(nodes: Ints, tree: Tree, told: Labelled) -> tuple[Grown, Labelled]:
    order = np.array(tree.order)
    place = np.empty_like(order)
    place[order] = np.arange(len(order))
    parent = place[tree.parent[order]]
    parent[0] = -1
    labelled = Labelled(
        label=told.label[order], best=told.best[order], other=told.other[order], value=told.value
    )
    return Grown(nodes=nodes[order], parent=parent), labelled


def _better_parents(ways: Straight, nodes: Ints, tree: Tree, told: Labelled) -> Ints:
    """The parents (M,) with branches hung elsewhere; of those that are in each other's way one."""
    forks = np.flatnonzero([
        above > 0 and len(tree.children[above]) > 1 for above in tree.parent.tolist()
    ])  # fmt: skip
    forks = forks[tree.reach[forks] + tree.step[forks] >= LEAST_M]
    parent = tree.parent.copy()
    if len(forks) == 0:
        return parent
    row, host = _places(tree, forks)
    kept = (host != row) & (host != 0)
    row, host = row[kept], host[kept]
    value = _value(ways, nodes, tree, told, row, host)
    now = _value(ways, nodes, tree, told, forks, tree.parent[forks])
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


def _places(tree: Tree, rows: Ints) -> tuple[Ints, Ints]:
    """Rows and hosts (B,) on which each may hang: what is near, and ends not much farther."""
    tips = np.flatnonzero(tree.only_child == TIP)
    near = cKDTree(tree.xyz).query_ball_point(tree.xyz[rows], REACH_M)
    ends = cKDTree(tree.xyz[tips]).query_ball_point(tree.xyz[rows], END_REACH_M)
    hosts = [np.union1d(some, tips[ahead]) for some, ahead in zip(near, ends, strict=True)]
    row = np.repeat(rows, [len(some) for some in hosts])
    return row, np.concatenate(hosts).astype(np.int64)


def _free(parent: Ints, moved: Bools, row: int, host: int) -> bool:
    """Whether neither was moved in this round, and the host is not above the row."""
    if moved[row] or moved[host]:
        return False
    while host >= 0 and host != row:
        host = int(parent[host])
    return host != row


def _value(
    ways: Straight, nodes: Ints, tree: Tree, told: Labelled, row: Ints, host: Ints
) -> Floats:
    """What it is worth (B,) if branches hang by their first row on hosts, whose labels stay."""
    label = told.label[host]
    fork = np.where(_goes_on(tree, told, row, host), FORK[label], 0.0)
    as_same = told.best[row, label] - TURN * tree.turn_from(host, row) - fork
    outward = np.column_stack([nodes[host], nodes[row]])
    cost = growth_costs(ways.threads, outward, ways.leave_wood(row, host))
    return np.asarray(np.maximum(told.other[row, label], as_same) - COST * cost)


def _leaves_wood(threads: Threads, start: Floats, end: Floats) -> Bools:
    """Whether straight ways (B,) from some places (B, 3) to others go through the open."""
    far = np.flatnonzero(np.linalg.norm(end - start, axis=1) > NEAR_M)
    share = np.linspace(0, 1, BETWEEN + 2)[1:-1, None, None]
    away, node = threads.tree.query(start[far] + share * (end - start)[far])
    cover = np.maximum(threads.radius, THIN_M) + COVER_M
    leaves = np.zeros(len(start), np.bool_)
    leaves[far] = (away > cover[node]).any(axis=0)
    return leaves


def _goes_on(tree: Tree, told: Labelled, row: Ints, host: Ints) -> Bools:
    """Whether something else (B,) than the row goes on from the host with the host's label."""
    alike = told.label[1:] == told.label[tree.parent[1:]]
    count = np.bincount(tree.parent[1:][alike], minlength=len(tree.parent))
    itself = (tree.parent[row] == host) & (told.label[row] == told.label[host])
    return np.asarray(count[host] > itself)
