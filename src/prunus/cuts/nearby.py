"""What points of a scan say of a branch to be cut: at the cut, behind its parent, at its tip."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from prunus.cuts.limbs import Limb, Limbs
from prunus.geometry.exits import stretch_near
from prunus.geometry.near import away_from, within
from prunus.geometry.vectors import unit
from prunus.model import Floats
from prunus.model.arrays import cubes

AROUND_M = 0.30
"""Points within this of a cut are looked at."""
CLOSE_M = 0.18
"""Points within this of a cut tell whether a branch is there."""
CLEAR_M = 0.010
"""Points within this of the parent's bark are taken for the parent's."""
AT_CUT_M = 0.03
"""Points within this of a cut tell whether a thin branch is there."""
LINE = (-0.01, 0.05, 0.025)
"""The line of a branch is that of points so far along from the cut, from and to, and beside it."""
FEWEST = 6
"""Fewer points tell no line."""
NO_LINE_M = 0.02
"""How far aside the line of a branch counts where its points tell none."""
BACK_M = (0.02, 0.10, 0.01)
"""Behind the parent wood is looked for from here, to there, in such steps."""
BESIDE_M = 0.012
"""Such a place has wood where points lie within this of it,"""
MIN_POINTS = 3
"""and so many of them."""
PAST, AHEAD, OFF = 0.08, 0.02, 0.02
"""Wood goes on past a tip where points lie so near it, so far ahead, and so far off all bark."""
CUBE_M = 0.01
"""Points past a tip are counted once in cubes of this side."""


@dataclass(frozen=True, eq=False)
class Nearby:
    """Points of a scan around a cut (Q, 3), and those around the tip of its branch (T, 3)."""

    cut: Floats
    tip: Floats


def nearby(scan: Floats, cuts: Floats, tips: Floats) -> list[Nearby]:
    """The points of a scan (P, 3) near each of some cuts (C, 3) and tips (C, 3)."""
    both = zip(_around(scan, cuts, AROUND_M), _around(scan, tips, PAST), strict=True)
    return [Nearby(*pair) for pair in both]


def _around(scan: Floats, places: Floats, reach: float) -> list[Floats]:
    if len(places) == 0 or len(scan) == 0:
        return [scan[:0]] * len(places)
    start, members = within(np.ascontiguousarray(scan), places, reach)
    return [scan[members[low:high]] for low, high in pairwise(start)]


def told_by_points(
    limbs: Limbs, limb: Limb, radius: float, along: float, points: Nearby
) -> dict[str, float]:
    """The evidence of a cut along a limb that the points give; `radius` is that of its parent.

    See `Evidence`. A limb at the base has no parent, and nothing is told of it.
    """
    parent = limbs.parent_of(limb)
    if parent is None:
        return {}
    cut = limb.at(along)
    near = points.cut[((points.cut - cut) ** 2).sum(axis=1) < CLOSE_M**2]
    clear = near[away_from(near, stretch_near(parent.xyz, cut)) > radius + CLEAR_M]
    beside = away_from(clear, stretch_near(limb.xyz, cut))
    here = np.linalg.norm(clear - cut, axis=1) < AT_CUT_M
    return {
        "spread": float(beside[here].mean()) if here.any() else AT_CUT_M,
        "aside": _aside(clear, beside, cut, limb.heading(along)),
        "behind": _behind(limb, radius, along, clear),
        "past": _past(limbs, limb, points.tip),
    }


def _aside(clear: Floats, beside: Floats, cut: Floats, heading: Floats) -> float:
    """How far from the cut the main axis of the points along the branch passes."""
    low, high, most = LINE
    way = (clear - cut) @ heading
    some = clear[(way > low) & (way < high) & (beside < most)]
    if len(some) < FEWEST:
        return NO_LINE_M
    middle = some.mean(axis=0)
    axis = np.linalg.svd(some - middle, full_matrices=False)[2][0]
    off = cut - middle
    return float(np.linalg.norm(off - (off @ axis) * axis))


def _behind(limb: Limb, radius: float, along: float, clear: Floats) -> float:
    """The share of the places straight behind the parent that have wood."""
    foot = limb.at(limb.bark)
    ahead = unit(limb.at(along + 2 * AT_CUT_M) - foot)
    places = foot - (2 * radius + np.arange(*BACK_M))[:, None] * ahead
    if len(clear) == 0:
        return 0.0
    start, _ = within(np.ascontiguousarray(clear), places, BESIDE_M)
    return float((np.diff(start) >= MIN_POINTS).mean())


def _past(limbs: Limbs, limb: Limb, points: Floats) -> float:
    """How many cubes hold points ahead of the tip of a limb that no limb explains."""
    tip = limb.xyz[-1]
    ahead = unit(tip - limb.at(max(float(limb.along[-1]) - AT_CUT_M, 0.0)))
    some = points[(points - tip) @ ahead > AHEAD]
    radius = np.nan_to_num(limbs.skeleton.radius, nan=CUBE_M)
    for other in limbs.all:
        if len(some) == 0:
            return 0.0
        some = some[away_from(some, other.xyz) > OFF + radius[other.rows[1:]].max()]
    return float(len(np.unique(cubes(some, CUBE_M)))) if len(some) else 0.0
