"""Which axis of a cloud points up, by the evidence in the cloud.

Ground says it best. Without, the tree does: most wood runs upright, the longest straight wood
reaches from end to end, what lies below any height hangs together while what lies above falls
apart into branches, and upright wood is thicker below.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from prunus.frames.ground import Ground, is_flat
from prunus.frames.patches import Cells, Patches
from prunus.geometry.near import within
from prunus.geometry.pieces import components
from prunus.model import Floats, Ints

UPWARD = {
    (2, 1): "z-up",
    (1, -1): "optical",
    (1, 1): "y-up",
    (0, 1): "x-up",
    (2, -1): "z-down",
    (0, -1): "x-down",
}
"""The frame in which an axis (0, 1, 2) points up (1) or down (-1), the most usual first."""
PATCH_M = 0.10
"""Radius of the pieces of wood that are looked at."""
ROOTED, TALL, MOST_ROOTED = 0.2, 0.4, 2.0
"""How much roots count, and long straight wood, beside the share of wood along an axis (logs).
The weights suit 60 simulated trees and scans and 96 drawn ones of four other habits."""
CLOSE = 0.15
"""An axis is as good as another when it scores so little less."""
SIGN = 0.35
"""What is rooted so little at one end of an axis more than at the other could stand either way."""
HEIGHTS = np.linspace(0.1, 0.9, 9)
"""The tree is cut at these shares of its cells."""
FALLEN = 0.03
"""Where so small a share falls apart it hangs together."""
JOINED = 2.5
"""Cells hang together over so many sides."""
COLUMN_M, STEP_M = 0.12, 0.10
"""Straight wood is looked for in columns so wide, in steps so high."""
END, UPRIGHT, LINE = 0.20, 0.8, 0.5
"""Wood is thick or thin at so large a share of the height from either end, where it runs along
the axis by so much, and is a line by so much."""


@dataclass(frozen=True)
class Up:
    """The frame that the evidence is for, why, and the frames that it could be as well."""

    frame: str
    why: str
    others: tuple[str, ...] = ()


def local_wood(cells: Cells) -> Patches:
    """Pieces of wood in a scan."""
    patches = Patches.of(cells, max(PATCH_M, 3 * cells.side))
    return patches.take(~is_flat(patches))


def find_frame(cells: Cells, wood: Patches, ground: Ground | None) -> Up:
    """The frame of a scan, from its cells without ground, its wood and its ground."""
    if ground is not None:
        axis = int(np.abs(ground.up).argmax())
        way = 1 if ground.up[axis] > 0 else -1
        return Up(UPWARD[axis, way], f"the ground lies across {_named(axis)}, the rest above it")
    share = wood_along_axes(wood)
    roots = rooted(cells) + thicker_below(wood)
    score = (
        np.log(share)
        + ROOTED * np.minimum(np.abs(roots), MOST_ROOTED)
        + TALL * np.log(reach(cells))
    )
    likely = [
        name
        for (axis, way), name in UPWARD.items()
        if score[axis] > score.max() - CLOSE and way * roots[axis] > -SIGN
    ]
    axis = next(axis for (axis, _), name in UPWARD.items() if name == likely[0])
    why = f"{share[axis]:.0%} of the wood runs along {_named(axis)}"
    return Up(likely[0], f"{why}, rooted below" if len(likely) == 1 else why, tuple(likely[1:]))


def _named(axis: int) -> str:
    return "XYZ"[axis]


def wood_along_axes(wood: Patches) -> Floats:
    """Share (3,) of the wood that runs along each axis; thick wood counts for more."""
    weight = wood.linear * np.sqrt(wood.variance[:, 1])
    along = (weight[:, None] * wood.directions**2).sum(axis=0) + 1e-12
    return np.asarray(along / along.sum())


def reach(cells: Cells) -> Floats:
    """How much of the extent along each axis (3,) the longest straight column of wood has."""
    found = np.ones(3)
    for axis in range(3):
        aside = np.rint(np.delete(cells.xyz, axis, axis=1) / COLUMN_M)
        along = np.rint(cells.xyz[:, axis] / STEP_M)
        held = np.unique(np.column_stack([aside, along]), axis=0)
        _, steps = np.unique(held[:, :2], axis=0, return_counts=True)
        low, high = np.quantile(cells.xyz[:, axis], [0.01, 0.99])
        found[axis] = min(1.0, steps.max() * STEP_M / max(high - low, STEP_M))
    return found


def rooted(cells: Cells) -> Floats:
    """How much better what lies low on each axis (3,) hangs together than what lies high (log).

    Only what hangs together as a whole counts: gaps in the scan are at both ends.
    """
    xyz = cells.xyz
    start, second = within(xyz, xyz, JOINED * cells.side)
    first = np.repeat(np.arange(len(xyz)), np.diff(start))
    joins = np.column_stack([first, second])[first < second]
    whole = components(len(xyz), joins)
    low, high = (
        np.array([_fallen(way * xyz[:, axis], joins, whole) for axis in range(3)])
        for way in (1, -1)
    )
    return np.asarray(np.log((high + FALLEN) / (low + FALLEN)))


def _fallen(height: Floats, joins: Ints, whole: Ints) -> float:
    """The mean share of what lies below a height that has fallen off what it is a part of."""
    shares = []
    for level in np.quantile(height, HEIGHTS):
        below = height <= level
        piece = components(len(height), joins[below[joins].all(axis=1)])
        size = np.bincount(piece[below], minlength=len(height))
        largest = np.zeros(len(height), np.int64)
        np.maximum.at(largest, whole, size)
        shares.append(1 - largest.sum() / below.sum())
    return float(np.mean(shares))


def thicker_below(wood: Patches) -> Floats:
    """How much thicker the wood along each axis (3,) is at its low end than at its high (log)."""
    found = np.zeros(3)
    for axis in range(3 if len(wood.xyz) else 0):
        height = wood.xyz[:, axis]
        low, high = np.quantile(height, [0.005, 0.995])
        upright = (np.abs(wood.directions[:, axis]) > UPRIGHT) & (wood.linear > LINE)
        end = END * (high - low)
        below, above = upright & (height < low + end), upright & (height > high - end)
        if min(below.sum(), above.sum()) > 2:
            found[axis] = math.log(wood.count[below].mean() / wood.count[above].mean())
    return found
