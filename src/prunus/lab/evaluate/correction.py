"""The corrected skeleton S*: what is notably wrong mended on the same superpoints (evaluation.md).

A program plays the paper's evaluators. From parents to children, each true branch that counts gets
the path of superpoints that follows it and keeps most of the skeleton given. Branches that need
not be found stay as far as the skeleton given holds them.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from prunus.geometry.near import within
from prunus.lab.evaluate.compared import compared
from prunus.lab.evaluate.curves import SPACING
from prunus.lab.evaluate.seen import COUNTS
from prunus.model import Bools, Floats, Label, Skeleton, parents_first
from prunus.model.arrays import GRID
from prunus.rules import can_leave

STAYS = 0.06
"""A path stays within so many metres of its branch; so do both ends and the middle of an edge."""
HOP = 0.20
"""Edges over so many metres, 2 r_super, are drawn only across gaps."""
GAP = 50.0
"""What each metre more costs, in edits."""
ASTRAY = 5.0
"""What an edge costs whose middle leaves the branch, in edits; more than the way along it."""
EPSILON = 1e-3
"""What a metre costs between paths of as many edits."""


@dataclass(frozen=True, eq=False, kw_only=True)
class TrueBranch:
    """A true branch as far as the scan shows it: a point (S, 3) every centimetre from its parent.

    `leaves` is where it leaves its parent, metres along that; `needed`: it must be in S*.
    """

    label: Label
    line: Floats
    parent: int
    leaves: float
    needed: bool


@dataclass(eq=False, kw_only=True)
class Correction:
    """S* as it grows. `into`: the node before each and the label; `at`: branch and way along it."""

    nodes: Floats
    given: dict[tuple[int, int], int]
    true: list[TrueBranch]
    root: int
    into: dict[int, tuple[int, int]] = field(default_factory=dict)
    at: dict[int, tuple[int, float]] = field(default_factory=dict)

    def holds(self, node: int) -> bool:
        """Whether the node is in S*."""
        return node == self.root or node in self.into


def corrected(predicted: Skeleton, nodes: Floats, truth: Skeleton, counts: Bools) -> Skeleton:
    """S* for a skeleton on superpoints `nodes` (N, 3), all in one frame.

    `counts` (M,) are the rows of the true tree that count, see `counting_rows`.
    """
    true = true_branches(predicted, truth, counts)
    nearby = _Nearby.of(nodes, true)
    work = Correction(
        nodes=nodes, given=_pairs(predicted), true=true, root=int(predicted.superpoint[0])
    )
    for number, branch in enumerate(true):
        if branch.needed:
            _draw(work, number, nearby)
    _keep_the_rest(work, nearby)
    return _as_skeleton(work)


def true_branches(predicted: Skeleton, truth: Skeleton, counts: Bools) -> list[TrueBranch]:
    """The branches of the true tree, forks as the predicted tree has them, parents first."""
    theirs = compared(predicted, truth)[1]
    lines = [_line(truth.xyz[branch.rows]) for branch in theirs.branches]
    found: list[TrueBranch] = []
    for branch, parent, line in zip(theirs.branches, theirs.parent.tolist(), lines, strict=True):
        rows = branch.rows[1:]
        seen = np.flatnonzero(counts[rows])
        kept = rows[: seen[-1] + 1] if len(seen) else rows
        forks = parent >= 0 and branch.rows[0] not in theirs.branches[parent].rows
        grows = can_leave(theirs.branches[parent].label if parent >= 0 else None, branch.label)
        long = truth.lengths[rows[seen]].sum() >= COUNTS - GRID
        size = 1 + round(float(truth.lengths[kept].sum()) / SPACING)
        leaves = _way_to(lines[parent], line[0]) if parent >= 0 else 0.0
        needed = bool(long and grows and not forks)
        found.append(
            TrueBranch(
                label=branch.label, line=line[:size], parent=parent, leaves=leaves, needed=needed
            )
        )
    return found


@dataclass(frozen=True, eq=False)
class _Nearby:
    """By branch: the nodes within `STAYS` of it and how far along; of each node the nearest one."""

    along: list[dict[int, float]]
    nearest: dict[int, int]

    @classmethod
    def of(cls, nodes: Floats, true: list[TrueBranch]) -> _Nearby:
        samples = np.concatenate([branch.line for branch in true])
        owner = np.repeat(np.arange(len(true)), [len(branch.line) for branch in true])
        way = np.concatenate([SPACING * np.arange(len(branch.line)) for branch in true])
        start, members = within(samples, nodes, STAYS)
        node = np.repeat(np.arange(len(nodes)), np.diff(start))
        away = np.linalg.norm(samples[members] - nodes[node], axis=1)
        along: list[dict[int, float]] = [{} for _ in true]
        nearest: dict[int, int] = {}
        for k in np.argsort(away, kind="stable"):
            n, branch = int(node[k]), int(owner[members[k]])
            along[branch].setdefault(n, float(way[members[k]]))
            nearest.setdefault(n, branch)
        return cls(along, nearest)


def _draw(work: Correction, number: int, nearby: _Nearby) -> None:
    """Draw the best path along a branch, if a superpoint shows it."""
    along = {n: t for n, t in nearby.along[number].items() if not work.holds(n)}
    own = [t for n, t in along.items() if nearby.nearest[n] == number]
    if not own:
        return
    along = _in_step(work, along)
    end = max(t for n, t in along.items() if nearby.nearest[n] == number) - STAYS
    order = sorted(along, key=lambda n: (along[n], n))
    best: dict[int, tuple[float, int]] = {}
    starts = _starts(work, number, nearby.along[number])
    for place, node in enumerate(order):
        ways = [(_cost(work, number, start, node), start) for start in starts]
        ways += [
            (best[other][0] + _cost(work, number, other, node), other) for other in order[:place]
        ]
        best[node] = min(ways)
    node = min((n for n in order if along[n] >= end), key=lambda n: best[n])
    while node not in starts:
        before = best[node][1]
        work.into[node] = (before, int(work.true[number].label))
        work.at[node] = (number, along[node])
        node = before


def _in_step(work: Correction, along: dict[int, float]) -> dict[int, float]:
    """How far along each node is, so that what the skeleton given joins lies in its order.

    A superpoint in a bend or beside the branch may lie a little behind the one before it.
    """
    joined: dict[int, list[int]] = {}
    for i, j in work.given:
        if i in along and j in along:
            joined.setdefault(i, []).append(j)
    found: dict[int, float] = {}
    for first in sorted(along, key=lambda n: (along[n], n)):
        waiting = [] if first in found else [(first, along[first])]
        while waiting:
            node, way = waiting.pop()
            found[node] = way
            for other in joined.get(node, []):
                if other not in found and along[other] > along[node] - STAYS:
                    waiting.append((other, max(along[other], way + EPSILON)))
    return found


def _starts(work: Correction, number: int, along: dict[int, float]) -> list[int]:
    """Nodes of S* from which a branch may leave.

    Those of its parent near the place, and those along which it runs beside its parent: nobody
    sees where in one thick piece of wood a second begins. Else the nearest node.
    """
    branch = work.true[number]
    if branch.parent < 0:
        return [work.root]
    near = [n for n, (k, t) in work.at.items()
            if k == branch.parent and (abs(t - branch.leaves) <= HOP or n in along)]  # fmt: skip
    if near:
        return near
    nodes = [work.root, *work.at]
    away = np.linalg.norm(work.nodes[nodes] - branch.line[0], axis=1)
    return [nodes[int(away.argmin())]]


def _cost(work: Correction, number: int, one: int, other: int) -> float:
    """What an edge of a path costs: an edit, or one less where the skeleton given has it."""
    length = float(np.linalg.norm(work.nodes[one] - work.nodes[other]))
    strays = not _stays(work, number, one, other)
    if (one, other) in work.given and not strays:
        return -1.0 + EPSILON * length
    return 1.0 + EPSILON * length + GAP * max(length - HOP, 0.0) + ASTRAY * strays


def _stays(work: Correction, number: int, one: int, other: int) -> bool:
    """Whether the middle of an edge is near the branch, or near where it leaves its parent."""
    middle = (work.nodes[one] + work.nodes[other]) / 2
    branch = work.true[number]
    lines = [branch.line]
    if branch.parent >= 0:
        at = round(branch.leaves / SPACING)
        reach = round(HOP / SPACING)
        lines.append(work.true[branch.parent].line[max(at - reach, 0) : at + reach])
    return any(
        len(line) > 0 and bool((np.linalg.norm(line - middle, axis=1) <= STAYS).any())
        for line in lines
    )


def _keep_the_rest(work: Correction, nearby: _Nearby) -> None:
    """Keep what the skeleton given holds of branches that need not be found."""
    optional = [k for k, branch in enumerate(work.true) if not branch.needed]
    waiting = True
    while waiting:
        waiting = False
        for (one, other), label in work.given.items():
            if not work.holds(one) or work.holds(other):
                continue
            for k in optional:
                near = nearby.along[k]
                same = work.true[k].label == label
                if same and other in near and _stays(work, k, one, other):
                    work.into[other] = (one, label)
                    work.at[other] = (k, near[other])
                    waiting = True
                    break


def _pairs(skeleton: Skeleton) -> dict[tuple[int, int], int]:
    """The edges of a skeleton as pairs of superpoints, either way round, with their labels."""
    ends = skeleton.superpoint[skeleton.edges].tolist()
    labels = skeleton.label[1:].tolist()
    both = [((i, j), label) for (i, j), label in zip(ends, labels, strict=True)]
    return dict(both) | {(j, i): label for (i, j), label in both}


def _line(points: Floats) -> Floats:
    """A point every `SPACING` along a polyline (Q, 3), from its beginning."""
    way = np.concatenate([[0], np.linalg.norm(np.diff(points, axis=0), axis=1).cumsum()])
    at = np.arange(0, way[-1] + SPACING / 2, SPACING)
    return np.column_stack([np.interp(at, way, points[:, axis]) for axis in range(3)])


def _way_to(line: Floats, point: Floats) -> float:
    """How far along a line (S, 3) it is nearest to a point."""
    return SPACING * float(np.linalg.norm(line - point, axis=1).argmin())


def _as_skeleton(work: Correction) -> Skeleton:
    before = {node: above for node, (above, _) in sorted(work.into.items())}
    nodes, parent = parents_first(work.root, before)
    label = [work.into[node][1] for node in nodes[1:]]
    label = [label[0] if label else int(Label.TRUNK), *label]
    return Skeleton.build(work.nodes[nodes], parent, label, superpoint=nodes)
