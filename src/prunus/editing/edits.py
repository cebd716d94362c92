"""Edit distances between a skeleton S and its correction S* (sec. Results; docs/evaluation.md)."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from prunus.model import Bools, Floats, Ints, Label, Skeleton

Pair = tuple[int, int]
ONE_A_TREE = (Label.TRUNK, Label.SUPPORT)
"""These labels count as one segment a tree, however many there are."""


@dataclass(frozen=True, kw_only=True)
class Edits:
    """What must be done to a skeleton to correct it, in edges.

    `wrong` are in S alone, `missing` in S* alone, `mislabelled` in both with other labels; `edges`
    are those of S*. By label: `differing` edges, contiguous `segments` of S*, edges in them.
    """

    wrong: int
    missing: int
    mislabelled: int
    edges: int
    differing: dict[Label, int]
    segments: dict[Label, int]
    segment_edges: dict[Label, int]

    @property
    def ratio(self) -> float:
        """The global edit ratio; NaN where S* has no edges."""
        distance = self.wrong + self.missing + self.mislabelled
        return distance / self.edges if self.edges else math.nan


def edits(skeleton: Skeleton, corrected: Skeleton) -> Edits:
    """The edits that turn a skeleton into its correction, both on the same superpoints.

    Where a label changes along a path of S*, one edge's leeway either way is not an error.
    """
    ours, theirs = _labelled(skeleton), _labelled(corrected)
    theirs = {pair: _excused(pair, ours, theirs, corrected) for pair in theirs}
    both = ours.keys() & theirs.keys()
    segments = {label: _segments(corrected, label) for label in Label}
    return Edits(
        wrong=len(ours.keys() - both),
        missing=len(theirs.keys() - both),
        mislabelled=sum(ours[pair] != theirs[pair] for pair in both),
        edges=len(theirs),
        differing={label: len(_with(ours, label) ^ _with(theirs, label)) for label in Label},
        segments=segments,
        segment_edges={label: int(corrected.edges_with(label).sum()) for label in Label},
    )


def unchanged(skeleton: Skeleton, corrected: Skeleton) -> Bools:
    """Which edges (M - 1,) of a skeleton its correction keeps as they are, label and all."""
    ours, theirs = _labelled(skeleton), _labelled(corrected)
    return np.array(
        [
            pair in theirs and _excused(pair, ours, theirs, corrected) == label
            for pair, label in ours.items()
        ],
        np.bool_,
    )


def on_same_nodes(one: Skeleton, other: Skeleton) -> tuple[Skeleton, Skeleton] | None:
    """Both with a number for every node: their superpoints', and for free points one by place.

    None where they do not share superpoints: where a number stands in both, so must the place. A
    base alone may stand lower than its superpoint.
    """
    known = one.superpoint[one.superpoint >= 0], other.superpoint[other.superpoint >= 0]
    shared = np.setdiff1d(np.intersect1d(*known), [one.superpoint[0], other.superpoint[0]])
    apart = _places(one, shared) - _places(other, shared)
    if len(shared) == 0 or np.abs(apart).max() > SAME_PLACE:
        return None
    first = int(max(*map(np.max, known))) + 1
    free = np.concatenate([tree.xyz[tree.superpoint < 0] for tree in (one, other)])
    _, number = np.unique(np.rint(free / SAME_PLACE), axis=0, return_inverse=True)
    ours, theirs = np.split(first + number.ravel(), [int((one.superpoint < 0).sum())])
    return _numbered(one, ours), _numbered(other, theirs)


SAME_PLACE = 1e-4
"""Nodes so near to each other, metres, are one."""


def _places(tree: Skeleton, superpoints: Ints) -> Floats:
    rows = {number: row for row, number in enumerate(tree.superpoint.tolist())}
    return tree.xyz[[rows[number] for number in superpoints.tolist()]]


def _numbered(tree: Skeleton, free: Ints) -> Skeleton:
    number = tree.superpoint.copy()
    number[number < 0] = free
    return replace(tree, superpoint=number)


def label_ratios(trees: list[Edits]) -> dict[Label, list[float]]:
    """The edit ratios of each label, one a tree, of a set of trees; NaN where S* has none of it.

    The denominator is the number of segments of the tree times the mean edges of one in the set.
    """
    found = {}
    for label in Label:
        mean = sum(e.segment_edges[label] for e in trees) / max(
            sum(e.segments[label] for e in trees), 1
        )
        found[label] = [
            e.differing[label] / (e.segments[label] * mean) if e.segments[label] else math.nan
            for e in trees
        ]
    return found


def _labelled(skeleton: Skeleton) -> dict[Pair, int]:
    """The edges as pairs of superpoints, the smaller first, with their labels."""
    pairs = np.sort(skeleton.superpoint[skeleton.edges], axis=1).tolist()
    return {(i, j): label for (i, j), label in zip(pairs, skeleton.label[1:].tolist(), strict=True)}


def _with(edges: dict[Pair, int], label: Label) -> set[Pair]:
    return {pair for pair, own in edges.items() if own == label}


def _excused(
    pair: Pair, ours: dict[Pair, int], theirs: dict[Pair, int], corrected: Skeleton
) -> int:
    """The label to expect of an edge of S*: the one given, if it changes there to just that."""
    given, true = ours.get(pair, theirs[pair]), theirs[pair]
    if given == true:
        return true
    rows = {int(node): row for row, node in enumerate(corrected.superpoint)}
    row = max(rows[pair[0]], rows[pair[1]])
    before = int(corrected.parent[row])
    around = corrected.label[corrected.parent == row].tolist()
    if before > 0:
        around.append(int(corrected.label[before]))
    return given if given in around else true


def _segments(skeleton: Skeleton, label: Label) -> int:
    """Contiguous segments of a label."""
    rows = np.flatnonzero(skeleton.edges_with(label))
    before = skeleton.parent[rows]
    begins = (before == 0) | (skeleton.label[before] != label)
    return min(int(begins.sum()), 1) if label in ONE_A_TREE else int(begins.sum())
