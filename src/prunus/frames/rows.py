"""Along which line the row of a scan runs, where there is evidence of one.

Long level wood (supports, cordons, wires) tells it where the ground plan of the scan is narrow
along the same line, and so do three trunks or more in line. The branches of a lone tree that run
all round it tell nothing.
"""

from __future__ import annotations

import math

import numpy as np

from prunus.frames.patches import Cells, Patches
from prunus.geometry.near import within
from prunus.geometry.pieces import components
from prunus.model import Floats, Ints

LEVEL = 0.35
"""Wood is level when it rises less than so many metres a metre."""
BESIDE = math.radians(12)
"""Wood runs along the row within so many radians, about; the ground plan does so, too."""
ALIKE, EVIDENCE_M, NARROW = 0.40, 0.20, 0.85
"""So large a share of the level wood runs along the row, or it is not trusted; nor if the square of
that share, times the metres of its runs, is less; nor that share, times how often more the ground
plan is drawn together along the row than on most lines."""
LINE = 0.5
"""Pieces of wood that are a line by so much make up runs,"""
JOINED_M = 0.12
"""in which they follow each other so near,"""
RUN_M = 0.30
"""that count from so long on."""
ONE_ASKEW_DEG, ROW_ASKEW_DEG = 15.0, 6.0
"""One tree, whose supports swerve, is turned when it is so far askew; a row when so far."""
ROW_M = 2.5
"""A row has so much in runs."""
SLICE_M = 0.05
"""The ground plan is looked at in slices so wide."""
COLUMN_M, STEP_M, TALL = 0.15, 0.10, 0.5
"""A trunk fills so much of the height of the scan, in a column so wide, in steps so high."""
APART_M = 0.30
"""Columns nearer to each other are one trunk."""
TRUNKS, IN_LINE_M, SPAN_M = 3, 0.15, 1.5
"""So many trunks, so near to a line, over such a length, are a row."""


def row_turn(cells: Cells, wood: Patches) -> float:
    """By how many radians a scan is to be turned about Z, so that its row runs along X.

    `cells` and `wood` are in a house frame, without ground. 0 where there is no evidence of a row,
    or it is but a little askew. A row across X is turned the way that keeps to within 90 degrees.
    """
    angle, share = row_angle(wood)
    metres = runs(wood, angle)
    line, times = narrowest(cells)
    if share >= ALIKE and share**2 * metres >= EVIDENCE_M:
        evident = share * times >= NARROW
    else:
        angle, metres = row_of_trunks(cells)
        evident = metres > 0
    askew = ROW_ASKEW_DEG if metres >= ROW_M else ONE_ASKEW_DEG
    evident = evident and abs(float(_between(np.array(line), angle))) <= BESIDE
    return -angle if evident and abs(math.degrees(angle)) >= askew else 0.0


def row_angle(wood: Patches) -> tuple[float, float]:
    """The angle about Z along which most level wood runs, from X; the share that runs so."""
    weight = wood.linear * np.sqrt(wood.variance[:, 1]) * (np.abs(wood.directions[:, 2]) < LEVEL)
    angles = np.arctan2(wood.directions[:, 1], wood.directions[:, 0])
    if weight.sum() <= 0:
        return 0.0, 0.0
    tried = np.radians(np.arange(-90, 90))
    best = float(tried[(_beside(angles, tried[:, None]) @ weight).argmax()])
    for _ in range(5):
        near = weight * _beside(angles, best)
        best += float((near * _between(angles, best)).sum() / near.sum())
    share = weight[np.abs(_between(angles, best)) < 1.5 * BESIDE].sum() / weight.sum()
    return float(_between(np.array(best), 0.0)), float(share)


def narrowest(cells: Cells) -> tuple[float, float]:
    """The angle from X, radians, along which the ground plan is drawn together most.

    And how often more so than on the median line.
    """
    angles = np.radians(np.arange(0, 180, 3))
    aside = cells.xyz[:, :2] @ np.stack([-np.sin(angles), np.cos(angles)])
    slices = np.rint(aside / SLICE_M).astype(np.int64)
    slices -= slices.min()
    held = [(np.bincount(column).astype(np.float64) ** 2).sum() for column in slices.T]
    return float(angles[int(np.argmax(held))]), float(np.max(held) / np.median(held))


def runs(wood: Patches, angle: float) -> float:
    """Metres of level wood that run on at an angle about Z, in runs of `RUN_M` or more."""
    level = (np.abs(wood.directions[:, 2]) < LEVEL) & (wood.linear > LINE)
    angles = np.arctan2(wood.directions[:, 1], wood.directions[:, 0])
    xyz = wood.xyz[level & (np.abs(_between(angles, angle)) < 1.5 * BESIDE)]
    if len(xyz) == 0:
        return 0.0
    run = _together(xyz, JOINED_M)
    along = xyz @ [math.cos(angle), math.sin(angle), 0.0]
    low, high = np.full(len(xyz), np.inf), np.full(len(xyz), -np.inf)
    np.minimum.at(low, run, along)
    np.maximum.at(high, run, along)
    length = (high - low)[np.isfinite(low)]
    return float(length[length >= RUN_M].sum())


def row_of_trunks(cells: Cells) -> tuple[float, float]:
    """The angle from X of the line on which trunks stand, radians, and its metres; 0 of none."""
    low, high = np.quantile(cells.xyz[:, 2], [0.01, 0.99])
    places = np.rint(cells.xyz / [COLUMN_M, COLUMN_M, STEP_M]).astype(np.int64)
    columns, steps = np.unique(np.unique(places, axis=0)[:, :2], axis=0, return_counts=True)
    tall = columns[steps * STEP_M >= TALL * (high - low)] * COLUMN_M
    if len(tall) < TRUNKS:
        return 0.0, 0.0
    trunk = _together(np.column_stack([tall, np.zeros(len(tall))]), APART_M)
    feet = np.array([tall[trunk == one].mean(axis=0) for one in np.unique(trunk)])
    if len(feet) < TRUNKS:
        return 0.0, 0.0
    way = np.linalg.eigh(np.cov(feet.T, bias=True))[1][:, 1]
    off, along = (feet - feet.mean(axis=0)) @ [-way[1], way[0]], feet @ way
    if np.abs(off).max() > IN_LINE_M or np.ptp(along) < SPAN_M:
        return 0.0, 0.0
    return float(_between(np.array(math.atan2(way[1], way[0])), 0.0)), float(np.ptp(along))


def _together(xyz: Floats, reach: float) -> Ints:
    """A number (Q,) for the group of each point (Q, 3), in which each has another in reach."""
    start, second = within(xyz, xyz, reach)
    first = np.repeat(np.arange(len(xyz)), np.diff(start))
    return components(len(xyz), np.column_stack([first, second]))


def _between(angles: Floats, other: Floats | float) -> Floats:
    """From one line to others, in -90 to 90 degrees, radians."""
    return np.asarray(np.angle(np.exp(2j * (angles - other))) / 2)


def _beside(angles: Floats, other: Floats | float) -> Floats:
    return np.asarray(np.exp(-0.5 * (_between(angles, other) / BESIDE) ** 2))
