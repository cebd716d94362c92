"""The cylinders that other tools make of a tree, as a skeleton."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from prunus.model import Floats, Ints, Label, Skeleton
from prunus.model.skeleton import parents_first


@dataclass(frozen=True, eq=False)
class Cylinders:
    """C cylinders: start (C, 3) of the axis, its direction (C, 3), length and radius (C,), metres.

    `parent` (C,) is the row on which each stands, -1 for none.
    """

    start: Floats
    axis: Floats
    length: Floats
    radius: Floats
    parent: Ints

    def __len__(self) -> int:
        return len(self.start)


def skeleton_of(cylinders: Cylinders) -> Skeleton:
    """The tree along the axes, from the first cylinder without a parent; all is called trunk.

    A cylinder leaves its parent's axis where that is nearest to its own start, and what lies
    between the two is an edge. What hangs on no cylinder of the tree is left out.
    """
    count = len(cylinders)
    end = cylinders.start + cylinders.axis * cylinders.length[:, None]
    foot, share = _feet(cylinders)
    xyz = np.concatenate([cylinders.start, end, foot])
    radius = np.concatenate(
        [cylinders.radius, cylinders.radius, cylinders.radius[cylinders.parent]]
    )
    before: dict[int, int] = {}
    for row in range(count):
        children = np.flatnonzero(cylinders.parent == row)
        along = children[np.argsort(share[children], kind="stable")].tolist()
        way = [row, *(2 * count + child for child in along), count + row]
        before |= dict(zip(way[1:], way[:-1], strict=True))
        before |= {child: 2 * count + child for child in along}
    nodes, parent = parents_first(int(np.argmax(cylinders.parent < 0)), before)
    return Skeleton.build(
        xyz[nodes], parent, np.full(len(nodes), Label.TRUNK), radius=radius[nodes]
    )


def _feet(cylinders: Cylinders) -> tuple[Floats, Floats]:
    """Where each leaves its parent's axis (C, 3), and how far along that is (C,), metres."""
    parent = cylinders.parent
    beside = cylinders.start - cylinders.start[parent]
    share = np.clip((beside * cylinders.axis[parent]).sum(axis=1), 0, cylinders.length[parent])
    return cylinders.start[parent] + cylinders.axis[parent] * share[:, None], share
