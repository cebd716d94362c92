"""When a candidate edge is valid, and what it is: labels from true trees (sec. Edge evaluation).

**Valid**: the edge follows a stretch of the wood of one tree. That is, there is a stretch from
within 6 cm of one end to within 6 cm of the other, the edge stays within 6 cm of it all along, and
the way along it is about as long as the edge (from half to 1.5 times and 4 cm). The 6 cm are those
within which an evaluator keeps an edge (evaluation.md): superpoints are means of balls of 10 cm
and lie beside the wood. The upper limit on the way decides on **edges that cut a corner**: one
between two legs of up to 10 cm is valid, since no better superpoint need exist there; one across
longer legs, or to the next leader, is not. The lower limit refuses edges across a thick branch.
A branch counts from the first to the last place where the scan holds points of it, when that is at
least 10 cm, and the half of it is seen (as in evaluation.md): nobody corrects what nobody can see.
Within it wood that the cameras missed counts: to bridge a gap in a leader is right. Wires, posts
and ground are no wood. The wood of a neighbour is wood.

**Category** of a valid edge: the label of most of its stretch, `OTHER` for shoots on trunk and
supports, which are no part of the UFO form (the paper's "something else").
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from prunus.geometry.near import within
from prunus.model import Bools, Floats, Ints, Label, Skeleton
from prunus.model.branches import branch_of_rows, branches

NEAR = 0.06
"""An edge keeps within so many metres of the wood that it follows."""
LONGEST = (1.5, 0.04)
"""The way along the wood is at most so many times the edge, and so many metres more."""
SHORTEST = 0.5
"""The way along the wood is at least so many times the edge."""
SAMPLES = np.linspace(0, 1, 7)[:, None]
"""An edge is looked at in so many places."""

OTHER = 4
"""Category of wood that is none of the labels."""
INVALID = -1
"""Category of an edge that is not valid."""
SOME = 5
"""Category of a valid edge of which nobody said what it is."""
UNTOLD = -2
"""Category of an edge of which nobody said anything."""


@dataclass(frozen=True, eq=False, kw_only=True)
class TrueWood:
    """All true trees in view as one table of M nodes.

    xyz (M, 3), parent (M,) with -1 at the bases, way (M,) along the wood from the base, category
    (M,) of the edge from the parent, branch (M,) numbered over all trees;
    counting: the rows that count as wood.
    """

    xyz: Floats
    parent: Ints
    way: Floats
    category: Ints
    branch: Ints
    counting: Ints

    @classmethod
    def of(cls, trees: list[Skeleton], counts: list[Bools] | None = None) -> TrueWood:
        """The table of some trees, all in one frame, and which rows (M,) of each count."""
        counts = counts or [np.ones(len(tree), np.bool_) for tree in trees]
        offsets = np.cumsum([0, *(len(tree) for tree in trees[:-1])])
        numbers = [np.maximum(branch_of_rows(branches(t), len(t)), 0) for t in trees]
        first = np.cumsum([0, *(own.max() + 1 for own in numbers[:-1])])
        pairs = list(zip(trees, offsets, strict=True))
        return cls(
            xyz=np.concatenate([tree.xyz for tree in trees]),
            parent=np.concatenate([np.where(t.parent < 0, -1, t.parent + o) for t, o in pairs]),
            way=np.concatenate([_ways(tree) for tree in trees]),
            category=np.concatenate([categories(tree) for tree in trees]),
            branch=np.concatenate([own + start for own, start in zip(numbers, first, strict=True)]),
            counting=np.flatnonzero(np.concatenate(counts)),
        )


def categories(tree: Skeleton) -> Ints:
    """The category (M,) of each edge: its label, `OTHER` for shoots that hang on no leader."""
    found = tree.label.astype(np.int64)
    for row in range(1, len(tree)):
        above = found[tree.parent[row]]
        if found[row] == Label.SIDE_BRANCH and above not in (Label.LEADER, Label.SIDE_BRANCH):
            found[row] = OTHER
    return found


def edge_labels(nodes: Floats, edges: Ints, wood: TrueWood) -> Ints:
    """The category (E,) of edges between nodes (N, 3), `INVALID` where they follow no wood."""
    found = np.full(len(edges), INVALID)
    samples = nodes[edges[:, :1]] * (1 - SAMPLES) + nodes[edges[:, 1:]] * SAMPLES
    start, members = within(wood.xyz[wood.counting], samples.reshape(-1, 3), NEAR)
    members = wood.counting[members]
    lengths = np.linalg.norm(nodes[edges[:, 1]] - nodes[edges[:, 0]], axis=1)
    counts = np.diff(start).reshape(len(edges), -1)
    for e in np.flatnonzero(counts.min(axis=1) > 0):
        first = e * len(SAMPLES)
        near = [members[start[s] : start[s + 1]] for s in range(first, first + len(SAMPLES))]
        stretch = _followed(wood, near, samples[e], lengths[e])
        if stretch is not None:
            found[e] = _most(wood, stretch)
    return found


def _followed(wood: TrueWood, near: list[Ints], at: Floats, length: float) -> Ints | None:
    """The stretch of wood that an edge follows, given the nodes near each of its samples."""
    between = [set(nodes.tolist()) for nodes in near[1:-1]]
    for one in _feet(wood, near[0], at[0]):
        for other in _feet(wood, near[-1], at[-1]):
            stretch = _stretch(wood, one, other, LONGEST[0] * length + LONGEST[1])
            if stretch is None or _way(wood, stretch) < SHORTEST * length:
                continue
            if all(not nodes.isdisjoint(stretch) for nodes in between):
                return np.array(stretch)
    return None


def _feet(wood: TrueWood, near: Ints, at: Floats) -> list[int]:
    """The nearest node of each branch near a place, the nearest branch first."""
    order = near[np.argsort(np.linalg.norm(wood.xyz[near] - at, axis=1))]
    _, first = np.unique(wood.branch[order], return_index=True)
    return [int(order[k]) for k in np.sort(first)]


def _stretch(wood: TrueWood, one: int, other: int, longest: float) -> list[int] | None:
    """The nodes from one to the other along the wood, the highest common one second to last.

    None where the way is over `longest` or there is none.
    """
    up, down = [one], [other]
    while one != other:
        if one > other:
            one = int(wood.parent[one])
            up.append(one)
        else:
            other = int(wood.parent[other])
            down.append(other)
        if min(one, other) < 0:
            return None
        if wood.way[up[0]] - wood.way[one] + wood.way[down[0]] - wood.way[other] > longest:
            return None
    return up + down[-2::-1]


def _way(wood: TrueWood, stretch: list[int]) -> float:
    top = min(stretch)
    return float(wood.way[stretch[0]] + wood.way[stretch[-1]] - 2 * wood.way[top])


def _most(wood: TrueWood, stretch: Ints) -> int:
    """The category of most of a stretch; the edge into its topmost node is no part of it."""
    edges = stretch[stretch != stretch.min()] if len(stretch) > 1 else stretch
    return int(np.bincount(wood.category[edges]).argmax())


def _ways(tree: Skeleton) -> Floats:
    way, lengths = np.zeros(len(tree)), tree.lengths
    for row in range(1, len(tree)):
        way[row] = way[tree.parent[row]] + lengths[row]
    return way
