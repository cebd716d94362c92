"""What the cameras see of a branch: a ribbon of points, in front of its axis.

Its width tells the radius. Several views that stand together a little wrong, and stereo, make it
wider and ragged: `noise` is by how much.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from prunus.geometry.vectors import unit
from prunus.model import Bools, Floats, Ints
from prunus.refine.centrelines import TINY, Centrelines
from prunus.refine.smoothing import Shares

CAMERA_AWAY_M = 1.5
"""Usual distance of the cameras from the tree, toward smaller Y."""
CAMERA_HEIGHT_M = 1.45
"""Usual height of the cameras over the base of the tree."""
FAN = 0.5
"""Several stand side by side along the row: places are seen askew by this share of their way from
the middle."""
MIDDLE = 0.5
"""The middle of a ribbon is that share of it."""
AROUND = 4
"""The width is that of the points up to so many stations away."""
FEWEST = 5.0
"""Of fewer points (weights summed) there is no width."""


@dataclass(frozen=True, eq=False)
class View:
    """How the stations of some lines are seen.

    `ray` (S, 3) is the direction of sight, `back` (S, 3) the part of it across the line, and `side`
    (S, 3) across both, all of length 1.
    """

    ray: Floats
    back: Floats
    side: Floats

    @classmethod
    def of(cls, lines: Centrelines, cameras: Floats) -> View:
        """The view of lines from cameras whose middle is at `cameras` (3,), house frame."""
        tangent = lines.tangents()
        ray = unit((lines.xyz - cameras) * [FAN, 1.0, 1.0])
        back = unit(ray - (ray * tangent).sum(axis=1, keepdims=True) * tangent)
        return cls(ray, back, np.cross(tangent, back))


def camera_place(lines: Centrelines, xyz: Floats) -> Floats:
    """The middle (3,) of the cameras that saw a tree, so far as its points (P, 3) tell."""
    ends = np.quantile(xyz[:, 0], (0.02, 0.98))
    return np.array(
        [ends.mean(), np.median(xyz[:, 1]) - CAMERA_AWAY_M, lines.xyz[0, 2] + CAMERA_HEIGHT_M]
    )


@dataclass(frozen=True, eq=False)
class Ribbons:
    """At each station: half the width (S,) of the ribbon, and the points (S,) at it, weighted.

    Half the width is NaN of too few points; that of an evenly filled ribbon from -h to h is h.
    `deep` (B,) is how deep each line's points lie along its middle, as a share of half the width:
    little of wood seen from one side, much of wood seen from all around; see `sides.py`.
    """

    half: Floats
    count: Floats
    deep: Floats

    @classmethod
    def of(cls, lines: Centrelines, view: View, points: Shares) -> Ribbons:
        """The ribbons of lines that run through the middle of their points."""
        size, at = len(lines.xyz), points.station
        share = points.share[:, None]
        here = lines.xyz[points.before] * (1 - share) + lines.xyz[points.before + 1] * share
        off = points.xyz - here
        across = (off * view.side[at]).sum(axis=1)
        sums = [points.summed(across**power, size) for power in (0, 1, 2)]
        count, mean, square = window(lines, np.column_stack(sums), AROUND).T
        some = np.where(count < FEWEST, np.nan, count)
        half = np.sqrt(3 * np.maximum(square / some - (mean / some) ** 2, 0.0))
        depth = (off * view.back[at]).sum(axis=1)
        deep = _deep(lines, at, across, depth, half[at], points.weight)
        return cls(half, sums[0], deep)


def _deep(
    lines: Centrelines, at: Ints, across: Floats, depth: Floats, half: Floats, weight: Floats
) -> Floats:
    """How deep the points (Q,) of each line lie along its middle; see `Ribbons`."""
    middle = np.flatnonzero(np.abs(across) < MIDDLE * half)
    line, weight, size = lines.line[at[middle]], weight[middle], len(lines.parent)
    square = np.bincount(line, weight * depth[middle] ** 2, size)
    return np.asarray(
        np.sqrt(square / (np.bincount(line, weight * half[middle] ** 2, size) + TINY))
    )


def window(lines: Centrelines, values: Floats, reach: int) -> Floats:
    """Sums of values (S, C) over the stations of the line up to `reach` away."""
    total = np.concatenate([np.zeros((1, values.shape[1])), values.cumsum(axis=0)])
    rows, line = np.arange(len(values)), lines.line
    low = np.maximum(rows - reach, lines.first[line])
    high = np.minimum(rows + reach, lines.last[line]) + 1
    return np.asarray(total[high] - total[low])


def supported(lines: Centrelines, count: Floats) -> Bools:
    """Which stations (S,) have points of their own, or within a station of them."""
    return np.asarray(window(lines, count[:, None], 1)[:, 0] >= AT_LEAST)


AT_LEAST = 3.0
"""Wood is held by a scan where three stations together have so many points."""
