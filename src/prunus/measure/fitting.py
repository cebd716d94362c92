"""Centre lines fitted to the points of a tree, round after round."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from prunus.kernels.feet import feet, within_parents
from prunus.kernels.lines import nearest_on_lines
from prunus.measure.centrelines import STEP, Centrelines, joined, unit
from prunus.measure.radii import Tapers, tapers
from prunus.measure.ribbons import Ribbons, View, camera_place
from prunus.measure.smoothing import Shares, Ties, smoothed
from prunus.measure.tips import drawn_out, kept
from prunus.model import Bools, Floats, Ints

REACHES = (0.05, 0.05, 0.04, 0.04, 0.04)
"""Points so near a line, metres, are its own; a round each."""
DEEP = 0.73, 0.0004
"""The axis lies behind the middle of the points by this share of the radius, and so many metres."""
CORE = 2.0
"""Points over so many half widths beside a line hardly count ..."""
CORE_LEAST = (0.030, 0.020, 0.012, 0.008, 0.006)
"""... and none under so many metres is that far, a round each."""
OUTSIDE = 1.4
"""A line takes points from where it is so many half widths of its parent beside it."""
AHEAD = 6
"""The direction in which a line leaves its parent is that of so many stations."""
SLIDE = 8
"""Its foot moves by so many stations in a round, at most."""
HELD = 0.15
"""It moves where that brings the lines nearer by this share of its way."""
TIED = (0.02, 0.02, 0.02, 0.01, 0.001)
"""Lines start on their parents: standard deviation in metres, a round each."""


@dataclass(frozen=True, eq=False)
class Fit:
    """Lines, and what was seen at their stations: points (S,), their view, and the radii."""

    lines: Centrelines
    count: Floats
    half: Floats
    tapers: Tapers
    inside: Bools
    foot: Ints


def fitted(lines: Centrelines, label: Ints, least: Ints, xyz: Floats) -> Fit:
    """Lines of some labels (B,) fitted to the points (P, 3) of their tree; the house frame.

    At least so many stations (B,) stay of each.
    """
    cameras = camera_place(lines, xyz)
    blank = np.full(len(lines.xyz), np.nan)
    fit = Fit(
        lines,
        blank,
        blank,
        tapers(lines, label, blank),
        np.zeros(len(blank), bool),
        np.zeros(0, np.int64),
    )
    for number in range(len(REACHES)):
        fit = _round(fit, label, least, xyz, cameras, number)
    return fit


def _round(
    fit: Fit, label: Ints, least: Ints, xyz: Floats, cameras: Floats, number: int
) -> Fit:
    lines, was = drawn_out(fit.lines)
    view = View.of(lines, cameras)
    radius = fit.tapers.radius[was]
    noise = fit.tapers.noise
    depth = (DEEP[0] * radius + DEEP[1])[:, None] * view.back
    front = replace(lines, xyz=lines.xyz - depth)
    half = np.hypot(radius / 0.93, noise)
    inside = within_parents(front.xyz, lines.start, lines.parent, OUTSIDE * half)
    points = _shares(front, inside, half, xyz, number)
    foot = _feet(lines, inside)
    ties = _ties(lines, foot, depth, TIED[number])
    middle = replace(front, xyz=smoothed(front, points, ties, noise))
    ribbons = Ribbons.of(middle, view, points)
    measured = np.where(inside, np.nan, ribbons.half)
    found = tapers(lines, label, measured)
    axes = middle.xyz + (DEEP[0] * found.radius + DEEP[1])[:, None] * view.back
    stays = kept(lines, was, ribbons.count, least)
    size = np.bincount(lines.line[stays], minlength=len(label))
    start = np.concatenate([[0], size.cumsum()])
    cut = replace(lines, xyz=axes[stays], start=start)
    t = Tapers(found.radius[stays], found.error[stays], found.unknown[stays], found.noise)
    out = Fit(
        cut, ribbons.count[stays], measured[stays], t, inside[stays], (np.cumsum(stays) - 1)[foot]
    )
    return out if number == len(REACHES) - 1 else _even(out, least)


def _even(fit: Fit, least: Ints) -> Fit:
    new = joined(fit.lines.lines(), fit.lines)
    a = fit.lines.way() + 100.0 * fit.lines.line
    b = new.way() + 100.0 * new.line
    r = np.interp(b, a, fit.tapers.radius)
    blank = np.full(len(b), np.nan)
    return Fit(
        new,
        blank,
        blank,
        Tapers(r, blank, np.zeros(len(b), np.int64), fit.tapers.noise),
        np.zeros(len(b), bool),
        np.zeros(0, np.int64),
    )


def _shares(front: Centrelines, inside: Bools, half: Floats, xyz: Floats, number: int) -> Shares:
    rows = np.flatnonzero(~inside)
    before, share, away = nearest_on_lines(xyz, front.xyz[rows], front.line[rows], REACHES[number])
    near = np.flatnonzero(before >= 0)
    before, share, away = rows[before[near]], share[near], away[near]
    core = np.maximum(CORE * half[before], CORE_LEAST[number])
    weight = 1 / (1 + (away / core) ** 2) ** 2
    weight[away > CORE * core] = 0
    points = xyz[near]
    end = front.last[front.line[before]]
    ahead = unit(front.xyz[end] - front.xyz[end - 1])
    over = ((points - front.xyz[end]) * ahead).sum(axis=1)
    weight[(over > 0.5 * STEP) & front.free[front.line[before]]] = 0
    some = weight > 0
    return Shares(points[some], before[some], share[some], weight[some])


def _feet(lines: Centrelines, inside: Bools) -> Ints:
    """The station (B,) of its parent at which each line starts; 0 for lines without a parent."""
    ends = lines.last[np.maximum(lines.parent, 0)]
    foot = feet(lines.xyz, lines.start, lines.parent, inside, AHEAD, SLIDE, HELD)
    return np.asarray(np.where(lines.goes_on, ends, np.maximum(foot, 0)))


def _ties(lines: Centrelines, foot: Ints, depth: Floats, err: float) -> Ties:
    """Each line's start tied to its parent: in front of the parent's axis by its own depth."""
    hung = np.arange(len(foot)) > 0
    first = lines.first[hung]
    return Ties(first, lines.xyz[foot[hung]] - depth[first], err)
