"""The lines of a skeleton, a station every centimetre: one line a branch, which starts on another.

A scan shows the side of the wood that faces the cameras. Lines are fitted to its points, and lie
in front of the axes by a share of the radius.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from prunus.geometry.vectors import unit
from prunus.model import Bools, Floats, Ints, Skeleton
from prunus.model.branches import Branch, branch_of_rows, branches

STEP = 0.01
"""Distance of the stations, metres."""
TINY = 1e-9


@dataclass(frozen=True, eq=False, kw_only=True)
class Centrelines:
    """S stations xyz (S, 3) of B lines; those of line b stand in the rows start[b] to start[b + 1].

    `parent` (B,) is the line from which each leaves, -1 for the first; `goes_on` (B,) where it
    leaves at the parent's end, `free` (B,) where its own end is a tip.
    """

    xyz: Floats
    start: Ints
    parent: Ints
    goes_on: Bools
    free: Bools

    @property
    def line(self) -> Ints:
        """The line (S,) of each station."""
        return np.repeat(np.arange(len(self.parent)), np.diff(self.start))

    @property
    def first(self) -> Ints:
        """The first station (B,) of each line."""
        return self.start[:-1]

    @property
    def last(self) -> Ints:
        """The last station (B,) of each line."""
        return self.start[1:] - 1

    def way(self) -> Floats:
        """Metres (S,) along the line from its first station."""
        steps = np.linalg.norm(np.diff(self.xyz, axis=0, prepend=self.xyz[:1]), axis=1)
        steps[self.first] = 0.0
        total = steps.cumsum()
        return np.asarray(total - total[self.first][self.line])

    def tangents(self) -> Floats:
        """Unit vectors (S, 3) along the lines."""
        rows = np.arange(len(self.xyz))
        line = self.line
        low = np.maximum(rows - 2, self.first[line])
        high = np.minimum(rows + 2, self.last[line])
        return unit(self.xyz[high] - self.xyz[low])

    def part(self, stays: Bools) -> Centrelines:
        """The lines of these stations (S,) only."""
        size = np.bincount(self.line[stays], minlength=len(self.parent))
        start = np.concatenate([[0], size.cumsum()])
        return replace(self, xyz=self.xyz[stays], start=start)

    def lines(self) -> list[Floats]:
        """The stations of each line."""
        return np.split(self.xyz, self.start[1:-1])


def joined(lines: list[Floats], like: Centrelines) -> Centrelines:
    """These lines in place of those of `like`, stations evenly set."""
    even = [evenly(line) for line in lines]
    start = np.concatenate([[0], np.cumsum([len(line) for line in even])])
    return replace(like, xyz=np.concatenate(even), start=start)


def carried(values: Floats, old: Centrelines, new: Centrelines) -> Floats:
    """Values (S,) at the old stations, at the new ones of the same lines."""
    places = new.way() + APART * new.line
    return np.interp(places, old.way() + APART * old.line, values)


APART = 1000.0
"""Metres from one line to the next, where all of them are laid end to end."""


def evenly(line: Floats) -> Floats:
    """A line (S, 3) with stations about `STEP` apart, both ends kept, two at least."""
    way = np.concatenate([[0.0], np.linalg.norm(np.diff(line, axis=0), axis=1).cumsum()])
    at = np.linspace(0.0, way[-1], max(2, round(float(way[-1]) / STEP) + 1))
    return np.column_stack([np.interp(at, way, line[:, axis]) for axis in range(3)])


def lines_of(skeleton: Skeleton) -> tuple[Centrelines, list[Branch]]:
    """The lines of a skeleton as they are, and the branch of each."""
    found = branches(skeleton)
    owner = branch_of_rows(found, len(skeleton))
    foot = np.array([branch.rows[0] for branch in found])
    end = np.array([branch.rows[-1] for branch in found])
    parent = owner[foot]
    goes_on = (parent >= 0) & (end[np.maximum(parent, 0)] == foot)
    like = Centrelines(
        xyz=np.zeros((0, 3)),
        start=np.zeros(1, np.int64),
        parent=parent,
        goes_on=goes_on,
        free=~np.isin(end, foot),
    )
    return joined([skeleton.xyz[branch.rows] for branch in found], like), found
