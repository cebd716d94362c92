"""A tree in pieces of one centimetre, each with the direction and the label of its branch."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from prunus.lab.evaluate.curves import SPACING
from prunus.model import Bools, Floats, Ints, Label, Skeleton
from prunus.model.branches import branches

REACH = 0.03
"""The direction at a place is that from so many metres before it to as many after.

Shorter edges have none: where nodes lie a centimetre apart it would be their noise.
"""
Stretch = tuple[Floats, Label]
"""A polyline (Q, 3) and its label."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Pieces:
    """Middles of pieces (S, 3), unit directions (S, 3) and labels (S,).

    `changes`: places (C, 3) where the label changes along the tree, from and to (C, 2).
    """

    xyz: Floats
    way: Floats
    label: Ints
    changes: tuple[Floats, Ints]

    def __len__(self) -> int:
        return len(self.xyz)

    def turns(self, reach: float) -> Bools:
        """Near which pieces the tree changes from which label to which: (S, L, L)."""
        near = np.zeros((len(self), len(Label), len(Label)), np.bool_)
        places, labels = self.changes
        around = cKDTree(self.xyz).query_ball_point(places, reach)
        for (one, other), here in zip(labels.tolist(), around, strict=True):
            near[here, one, other] = True
        return near


def pieces_of(tree: Skeleton) -> Pieces:
    """All of a tree."""
    every = np.ones(len(tree), np.bool_)
    return _pieces([(tree.xyz[b.rows], b.label) for b in branches(tree)], tree, every)


def asked_of(truth: Skeleton, counts: Bools) -> tuple[Pieces, Pieces]:
    """What is asked of a true tree, and all the rest of it.

    A branch is asked for from its foot to the last of its rows that count, gaps and all.
    """
    asked: list[Stretch] = []
    rest: list[Stretch] = []
    kept = np.zeros(len(truth), np.bool_)
    for branch in branches(truth):
        last = int(np.flatnonzero(counts[branch.rows[1:]]).max(initial=-1)) + 1
        kept[branch.rows[1 : last + 1]] = True
        asked.append((truth.xyz[branch.rows[: last + 1]], branch.label))
        rest.append((truth.xyz[branch.rows[last:]], branch.label))
    return _pieces(asked, truth, kept), _pieces(rest, truth, ~kept)


def _pieces(stretches: list[Stretch], tree: Skeleton, kept: Bools) -> Pieces:
    found = [_cut(line) for line, _ in stretches]
    xyz = np.concatenate([np.zeros((0, 3)), *(middles for middles, _ in found)])
    way = np.concatenate([np.zeros((0, 3)), *(ways for _, ways in found)])
    labels = [int(label) for _, label in stretches]
    label = np.repeat(np.array(labels, np.int64), [len(middles) for middles, _ in found])
    return Pieces(xyz=xyz, way=way, label=label, changes=_changes(tree, kept))


def _cut(line: Floats) -> tuple[Floats, Floats]:
    """Middles and directions of the pieces of a polyline (Q, 3); under half a piece is none."""
    along = np.concatenate([[0.0], np.linalg.norm(np.diff(line, axis=0), axis=1).cumsum()])
    length = float(along[-1])
    count = round(length / SPACING)
    at = (np.arange(count) + 0.5) * length / max(count, 1)
    before, here, after = (_at(line, along, at + step) for step in (-REACH, 0.0, REACH))
    way = after - before
    return here, way / np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1e-12)


def _at(line: Floats, along: Floats, at: Floats) -> Floats:
    """Points (S, 3) of a polyline so far along it; its ends beyond them."""
    return np.column_stack([np.interp(at, along, line[:, axis]) for axis in range(3)])


def _changes(tree: Skeleton, kept: Bools) -> tuple[Floats, Ints]:
    """Where rows that are kept have another label than their parent, and both labels."""
    rows = np.flatnonzero(kept & (tree.parent > 0))
    parent = tree.parent[rows]
    label = np.column_stack([tree.label[parent], tree.label[rows]]).astype(np.int64)
    differ = label[:, 0] != label[:, 1]
    return tree.xyz[parent[differ]], label[differ]
