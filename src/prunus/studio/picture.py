"""What there is to draw of one tree, in the house frame."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from prunus.model import Bools, Floats, Ints, Kind, PointCloud, SeededGraph, Skeleton
from prunus.model.arrays import Bytes
from prunus.model.branches import Branch, branch_of_rows, branches
from prunus.report.scene import LEFT_OUT

MOST_POINTS = 150_000
"""More points of a cloud are not sent to a browser."""


Colour = tuple[int, int, int]


def colour_of(text: str) -> Colour:
    """The colour that '#rrggbb' names."""
    return int(text[1:3], 16), int(text[3:5], 16), int(text[5:7], 16)


GREY: Colour = (172, 172, 172)
DEPTHS: tuple[Colour, ...] = ((215, 25, 28), (230, 160, 40), (120, 170, 60), (44, 80, 190))
"""The colours of points by depth, the nearest first."""
KINDS: dict[Kind, Colour] = {
    Kind.TARGET: (90, 90, 90),
    **{kind: colour_of(LEFT_OUT[kind]) for kind in Kind if kind in LEFT_OUT},
    Kind.STRAY: (240, 160, 210),
}
"""The colour of each kind of points, in the order of the kinds."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Picture:
    """A scan (P), what each point is (P,), and, once the chain has run, skeleton and graph.

    `nodes` (M,) are the numbers by which acts name the rows of the skeleton, `names` those of the
    branches into them; `machine` is the skeleton as the chain left it.
    """

    scan: PointCloud
    kind: NDArray[np.int8] | None = None
    skeleton: Skeleton | None = None
    graph: SeededGraph | None = None
    machine: Skeleton | None = None
    nodes: list[int] = field(default_factory=list)
    names: dict[int, str] = field(default_factory=dict)

    @cached_property
    def branches(self) -> list[Branch]:
        """The branches of the skeleton."""
        return [] if self.skeleton is None else branches(self.skeleton)

    @cached_property
    def owner(self) -> Ints:
        """The branch (M,) that holds the edge into each row; -1 at row 0."""
        return branch_of_rows(self.branches, len(self.nodes))

    def row(self, node: int | None) -> int | None:
        """The row of a node, None where the skeleton has it no more."""
        return self.nodes.index(node) if node in self.nodes else None

    @property
    def box(self) -> tuple[Floats, Floats]:
        """Low and high corner (3,) of the tree, or of all points where none is known yet."""
        xyz = self.scan.xyz if self.skeleton is None else self.skeleton.xyz
        return xyz.min(axis=0), xyz.max(axis=0)


@lru_cache(maxsize=4)
def thinned(points: int, most: int = MOST_POINTS) -> Ints:
    """At most so many rows of a cloud in random order, the same each time; any start is even."""
    rows = np.random.default_rng(0).permutation(points)[:most].copy()
    rows.setflags(write=False)
    return rows


@dataclass(frozen=True)
class Slab:
    """What of the depth is shown: Y from `near` to `far`, house frame, metres."""

    near: float = -np.inf
    far: float = np.inf

    def holds(self, xyz: Floats) -> Bools:
        """Which points (Q, 3) lie in it."""
        return np.asarray((xyz[:, 1] >= self.near) & (xyz[:, 1] <= self.far))

    def holds_edges(self, ends: Floats) -> Bools:
        """Which edges (E, 2, 3) have their middle in it."""
        return self.holds(ends.mean(axis=1))


def colours_of(picture: Picture, rows: Ints, by: str) -> Bytes:
    """The colour (R, 3) of some points: their own ('rgb'), by 'class' or 'depth', or grey."""
    if by == "rgb" and picture.scan.rgb is not None:
        return picture.scan.rgb[rows]
    if by == "class" and picture.kind is not None:
        return np.array(list(KINDS.values()), np.uint8)[picture.kind[rows]]
    if by == "depth":
        return _by_depth(picture, picture.scan.xyz[rows, 1])
    return np.broadcast_to(np.array(GREY, np.uint8), (len(rows), 3))


def _by_depth(picture: Picture, depth: Floats) -> Bytes:
    """From the nearest to the farthest of the tree, by steps between the colours of DEPTHS."""
    low, high = (float(corner[1]) for corner in picture.box)
    share = np.clip((depth - low) / max(high - low, 1e-9), 0.0, 1.0)
    steps = np.linspace(0.0, 1.0, len(DEPTHS))
    channels = [np.interp(share, steps, channel) for channel in zip(*DEPTHS, strict=True)]
    return np.asarray(np.rint(np.column_stack(channels)), np.uint8)
