"""Where lines end: drawn out beyond their tips, and cut where their points end."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from prunus.geometry.vectors import unit
from prunus.model import Bools, Floats, Ints
from prunus.refine.centrelines import STEP, Centrelines
from prunus.refine.ribbons import AT_LEAST, window

DRAWN_OUT_STATIONS = 8
"""A tip is drawn out straight by so many stations, and keeps those that points follow."""
DIRECTION_STATIONS = 6
"""The direction of a tip is that of so many stations, the last ones."""
GAP_STATIONS = 3
"""A gap of so many stations without points is not yet the end of a branch."""
MIN_DENSITY = 0.25
"""A station holds wood where it has this share of the points usual on its line."""


def drawn_out(lines: Centrelines) -> tuple[Centrelines, Ints]:
    """The lines with longer free ends, and for each station (S,) the one it was, or hangs on."""
    more = np.where(lines.free, DRAWN_OUT_STATIONS, 0)
    size = np.diff(lines.start) + more
    start = np.concatenate([[0], size.cumsum()])
    line = np.repeat(np.arange(len(size)), size)
    rank = np.arange(start[-1]) - start[line]
    was = np.minimum(lines.first[line] + rank, lines.last[line])
    beyond = (lines.first[line] + rank - was)[:, None]
    before = np.maximum(lines.last - DIRECTION_STATIONS, lines.first)
    way = unit(lines.xyz[lines.last] - lines.xyz[before])
    xyz = lines.xyz[was] + STEP * beyond * way[line]
    return replace(lines, xyz=xyz, start=start), was


def kept(lines: Centrelines, was: Ints, count: Floats, least: Ints) -> Bools:
    """Which stations (S,) stay of drawn-out lines, given their points (S,) and what they were.

    At least so many stay of each line (B,).
    """
    stays = np.ones(len(was), np.bool_)
    near = window(lines, count[:, None], 1)[:, 0]
    for number in np.flatnonzero(lines.free):
        low, high = lines.start[number], lines.start[number + 1]
        old = int(was[high - 1] - was[low])
        end = max(_end(near[low:high], old), int(least[number]) - 1)
        stays[low + end + 1 : high] = False
    return stays


def _end(count: Floats, old: int) -> int:
    """The last station of a line, given points (R,) at its stations; `old` was the last."""
    enough = max(AT_LEAST, MIN_DENSITY * float(np.median(count[: old + 1])))
    held = np.flatnonzero(count >= enough)
    if len(held) == 0:
        return old
    inner = held[held <= old]
    end = int(inner[-1]) if len(inner) else old
    for station in held[held > end].tolist():
        if station - end > GAP_STATIONS:
            break
        end = station
    return end
