"""Centre lines fitted to the points of a tree, round after round.

A round draws free ends out, gives each point to the nearest line, passes smooth lines through the
points, reads the radii off their widths, pushes the lines back to the axes, and cuts ends off.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from prunus.geometry.vectors import unit
from prunus.model import Bools, Floats, Ints, Label
from prunus.refine.centrelines import STEP, Centrelines, carried, joined
from prunus.refine.feet import feet, within_parents
from prunus.refine.lines import nearest_on_lines
from prunus.refine.radii import WIDE, Tapers, tapers
from prunus.refine.ribbons import Ribbons, View, camera_place, window
from prunus.refine.sides import ROUNDER, seen_around
from prunus.refine.smoothing import Shares, Ties, smoothed
from prunus.refine.tips import drawn_out, kept


@dataclass(frozen=True, kw_only=True)
class Round:
    """How near points are to be, and how firmly lines start on their parents, metres.

    `reach` is how far a line takes points from; `core` what is no distance yet, see `CORE`; `tied`
    the standard deviation of a line's start from its parent's axis; `every` how many points make
    one that is looked at.
    """

    reach: float
    core: float
    tied: float
    every: int


ROUNDS = (
    Round(reach=0.05, core=0.030, tied=0.020, every=3),
    Round(reach=0.05, core=0.020, tied=0.020, every=3),
    Round(reach=0.04, core=0.012, tied=0.020, every=2),
    Round(reach=0.04, core=0.008, tied=0.010, every=2),
    Round(reach=0.04, core=0.006, tied=0.001, every=1),
)
CORE = 2.0
"""Points over so many half widths beside a line hardly count."""
DEEP = (0.73, 0.0004)
"""The axis lies behind the middle of the points by this share of the radius, and so many metres."""
EXIT_HALF_WIDTHS = 1.4
"""A line takes points from where it is so many half widths of its parent beside that one's line."""
DIRECTION_STATIONS = 6
"""The direction in which a line leaves its parent is that of so many stations."""
MAX_SLIDE_STATIONS = 8
"""The foot of a line moves by so many stations in a round, at most."""
MISS_ERR = (0.005, 0.6)
"""Standard deviation of a foot from the straight line: metres, and a share of the noise."""
ASTRAY_ERR_M = 0.04
"""Standard deviation of a foot from where the skeleton has it."""
BENT = (0.45, 0.25, 0.03)
"""A leader leaves its support at that angle, usually, radians, with that standard deviation; and it
bends up, so that it misses the straight line by so much more, metres."""
ANY = (1.0, 100.0, 0.0)
"""Other branches leave at any angle, and straight."""
ALONE = 5
"""A line is held where the skeleton has it so many stations from any points."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Fit:
    """Lines, and at their stations the points (S,), weighted, and the radii.

    `foot` (B,) is the station of its parent at which each line starts; 0 where it has no parent.
    `home` (S, 3) is where the skeleton has the stations; `around` (B,) how far each line was seen
    from all around, see `sides.py`.
    """

    lines: Centrelines
    count: Floats
    tapers: Tapers
    foot: Ints
    home: Floats
    around: Floats


@dataclass(frozen=True, eq=False)
class Starts:
    """Where the skeleton has the starts of lines (B, 3), and how they leave (B, 3), see `BENT`."""

    place: Floats
    leaves: Floats

    @classmethod
    def of(cls, lines: Centrelines, label: Ints) -> Starts:
        """Those of lines of some labels (B,)."""
        bent = (label == Label.LEADER) & (label[np.maximum(lines.parent, 0)] == Label.SUPPORT)
        return cls(lines.xyz[lines.first], np.where(bent[:, None], BENT, ANY))

    def err(self, noise: float) -> Floats:
        """Standard deviations (B, 2), metres: from the straight line, and from `place`."""
        miss = np.sqrt(MISS_ERR[0] ** 2 + (MISS_ERR[1] * noise) ** 2 + self.leaves[:, 2] ** 2)
        return np.column_stack([miss, np.full(len(miss), ASTRAY_ERR_M)])


def fitted(lines: Centrelines, label: Ints, least: Ints, xyz: Floats) -> Fit:
    """Lines of some labels (B,) fitted to the points (P, 3) of their tree; the house frame.

    At least so many stations (B,) stay of each.
    """
    cameras = camera_place(lines, xyz)
    unseen = np.full(len(lines.xyz), np.nan)
    starts = Starts.of(lines, label)
    nowhere = np.zeros(len(label), np.int64)
    fit = Fit(
        lines=lines,
        count=unseen,
        tapers=tapers(lines, label, unseen),
        foot=nowhere,
        home=lines.xyz,
        around=np.zeros(len(label)),
    )
    for turn in ROUNDS:
        fit = _round(
            _evened(fit), label, least, xyz[:: turn.every], cameras, turn=turn, starts=starts
        )
    return fit


def _evened(fit: Fit) -> Fit:
    """The lines with even stations; the radii go with them."""
    even = joined(fit.lines.lines(), fit.lines)
    radius = carried(fit.tapers.radius, fit.lines, even)
    count = carried(np.nan_to_num(fit.count), fit.lines, even)
    home = np.column_stack([carried(column, fit.lines, even) for column in fit.home.T])
    return Fit(
        lines=even,
        count=count,
        tapers=replace(fit.tapers, radius=radius),
        foot=fit.foot,
        home=home,
        around=fit.around,
    )


def _round(
    fit: Fit,
    label: Ints,
    least: Ints,
    xyz: Floats,
    cameras: Floats,
    *,
    turn: Round,
    starts: Starts,
) -> Fit:
    lines, was = drawn_out(fit.lines)
    view = View.of(lines, cameras)
    radius, noise = fit.tapers.radius[was], fit.tapers.noise
    half = np.hypot(radius / WIDE, noise)
    depth = _depth(radius, view, fit.around[lines.line])
    front = replace(lines, xyz=lines.xyz - depth)
    inside = within_parents(front.xyz, lines.start, lines.parent, EXIT_HALF_WIDTHS * half)
    points = _shares(front, inside, half, xyz, turn)
    foot = _feet(lines, inside, starts, noise)
    ties = _ties(lines, foot, depth, turn.tied)
    home = _home(fit, was, lines.xyz)
    middle = replace(front, xyz=smoothed(front, home - depth, points, ties, noise))
    ribbons = Ribbons.of(middle, view, points)
    around = seen_around(lines, ribbons, noise)
    half = ribbons.half * (1 - ROUNDER * around[lines.line])
    found = tapers(lines, label, np.where(inside, np.nan, half))
    axes = replace(lines, xyz=middle.xyz + _depth(found.radius, view, around[lines.line]))
    stays = kept(lines, was, turn.every * ribbons.count, _least(lines, foot, least))
    row = np.cumsum(stays) - 1
    return Fit(
        lines=axes.part(stays),
        count=ribbons.count[stays],
        tapers=found.part(stays),
        foot=row[foot],
        home=home[stays],
        around=around,
    )


def _home(fit: Fit, was: Ints, now: Floats) -> Floats:
    """Where stations (S, 3) stay: where the skeleton has them if no points are near, else `now`."""
    near = window(fit.lines, fit.count[:, None], ALONE)[was] > 0
    home = fit.home[was] + now - fit.lines.xyz[was]
    return np.where(near, now, home)


def _depth(radius: Floats, view: View, around: Floats) -> Floats:
    """From the middle of the points to the axis (S, 3); nothing where seen from all `around`."""
    return np.asarray(((1 - around) * (DEEP[0] * radius + DEEP[1]))[:, None] * view.back)


def _shares(front: Centrelines, inside: Bools, half: Floats, xyz: Floats, turn: Round) -> Shares:
    """The points (P, 3) that lines take from outside their parents, and how much each counts."""
    rows = np.flatnonzero(~inside)
    before, share, away = nearest_on_lines(xyz, front.xyz[rows], front.line[rows], turn.reach)
    near = np.flatnonzero(before >= 0)
    before, away = rows[before[near]], away[near]
    core = np.maximum(CORE * half[before], turn.core)
    counts = (away <= CUT * core) & ~_beyond(front, before, xyz[near])
    fall = np.maximum(away / core - FLAT, 0.0) / (1 - FLAT)
    near, before, fall = near[counts], before[counts], fall[counts]
    return Shares(xyz=xyz[near], before=before, share=share[near], weight=1 / (1 + fall**2) ** 2)


FLAT = 0.5
"""Up to this share of the core all points count alike, so that edges of ribbons are not lost ..."""
CUT = 2.5
"""... and so many cores away they do not count at all."""


def _beyond(front: Centrelines, before: Ints, points: Floats) -> Bools:
    """Which points (Q, 3), nearest to stations (Q,), lie beyond the free end of their line."""
    line = front.line[before]
    end = front.last[line]
    ahead = unit(front.xyz[front.last] - front.xyz[front.last - 1])[line]
    over = ((points - front.xyz[end]) * ahead).sum(axis=1)
    return np.asarray((over > STEP / 2) & front.free[line])


def _feet(lines: Centrelines, inside: Bools, starts: Starts, noise: float) -> Ints:
    """The station (B,) of its parent at which each line starts; 0 for lines without a parent."""
    ends = lines.last[np.maximum(lines.parent, 0)]
    foot = feet(
        lines.xyz, lines.start, lines.parent, inside, home=starts.place, usual=starts.leaves,
        err=starts.err(noise), ahead=DIRECTION_STATIONS, slide=MAX_SLIDE_STATIONS,
    )  # fmt: skip
    return np.asarray(np.where(lines.goes_on, ends, np.maximum(foot, 0)))


def _least(lines: Centrelines, foot: Ints, least: Ints) -> Ints:
    """How many stations (B,) of each line stay at least: it goes on beyond all that it carries."""
    held = least.copy()
    hung = np.flatnonzero((lines.parent >= 0) & ~lines.goes_on)
    carrier = lines.parent[hung]
    np.maximum.at(held, carrier, foot[hung] - lines.first[carrier] + 2)
    return held


def _ties(lines: Centrelines, foot: Ints, depth: Floats, err: float) -> Ties:
    """Each line's start tied to its parent: in front of the parent's axis by its own depth."""
    hung = np.arange(len(foot)) > 0
    first = lines.first[hung]
    return Ties(first, lines.xyz[foot[hung]] - depth[first], err)
