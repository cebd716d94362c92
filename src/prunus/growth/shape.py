"""A grown tree as it is while parents may still change: who hangs on whom, lengths, directions."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from prunus.geometry.vectors import unit
from prunus.model import Floats, Ints

ALONG_M = 0.08
"""Over so much of a branch its direction is taken."""
TIP, FORKS = -1, -2
"""In place of the only row that hangs on one: none, or several."""


class Tree:
    """Rows xyz (M, 3) and the row `parent` on which each hangs; row 0 is the foot, -1 above it."""

    def __init__(self, xyz: Floats, parent: Ints) -> None:
        self.xyz, self.parent = xyz, parent
        self.step = np.linalg.norm(xyz - xyz[np.maximum(parent, 0)], axis=1)

    @cached_property
    def children(self) -> list[list[int]]:
        """The rows that hang on each."""
        found: list[list[int]] = [[] for _ in self.parent]
        for row, above in enumerate(self.parent.tolist()):
            if above >= 0:
                found[above].append(row)
        return found

    @cached_property
    def only_child(self) -> Ints:
        """The row (M,) that hangs on each where it is the only one; else `TIP` or `FORKS`."""
        count = np.bincount(self.parent[1:], minlength=len(self.parent))
        found = np.where(count > 1, FORKS, TIP)
        rows = np.arange(1, len(self.parent))
        single = rows[count[self.parent[1:]] == 1]
        found[self.parent[single]] = single
        return found

    @cached_property
    def levels(self) -> list[Ints]:
        """All rows but the foot in groups, tips first: what hangs on a row is in an earlier one."""
        height = np.zeros(len(self.parent), np.int64)
        parent = self.parent.tolist()
        for row in reversed(self.order[1:]):
            height[parent[row]] = max(height[parent[row]], height[row] + 1)
        order = np.argsort(height[1:], kind="stable") + 1
        return np.split(order, np.flatnonzero(np.diff(height[order])) + 1) if len(order) else []

    @cached_property
    def order(self) -> list[int]:
        """The rows, each after that on which it hangs."""
        found = [0]
        for row in found:
            found += self.children[row]
        return found

    @cached_property
    def reach(self) -> Floats:
        """The length (M,) of the longest way outward from each row."""
        found = np.zeros(len(self.parent))
        for row in reversed(self.order[1:]):
            above = self.parent[row]
            found[above] = max(found[above], found[row] + self.step[row])
        return found

    @cached_property
    def tail(self) -> Floats:
        """The direction (M, 3) in which wood comes to each row from below; zero at the foot."""
        at, length = np.arange(len(self.parent)), np.zeros(len(self.parent))
        for _ in range(len(self.parent)):
            goes = (self.parent[at] >= 0) & (length < ALONG_M)
            if not goes.any():
                break
            length += np.where(goes, self.step[at], 0.0)
            at = np.where(goes, self.parent[at], at)
        return unit(self.xyz - self.xyz[at])

    @cached_property
    def head(self) -> Floats:
        """The direction (M, 3) in which the longest branch goes on from each row; zero at tips."""
        longest = np.arange(len(self.parent))
        most = np.zeros(len(self.parent))
        for row in self.order[1:]:
            above, length = self.parent[row], self.reach[row] + self.step[row]
            if length > most[above]:
                longest[above], most[above] = row, length
        at, length = np.arange(len(self.parent)), np.zeros(len(self.parent))
        for _ in range(len(self.parent)):
            on = longest[at]
            goes = (on != at) & (length < ALONG_M)
            if not goes.any():
                break
            length += np.where(goes, self.step[on], 0.0)
            at = np.where(goes, on, at)
        return unit(self.xyz[at] - self.xyz)

    @cached_property
    def turn(self) -> Floats:
        """How much wood turns (M,) from the parent of each row to it."""
        return self.turn_from(np.maximum(self.parent, 0), np.arange(len(self.parent)))

    def turn_from(self, hosts: Ints, rows: Ints) -> Floats:
        """How much it would turn (B,) from hosts to rows that hang there: 0 straight on, 2 back."""
        onward = unit(self.xyz[rows] - self.xyz[hosts] + ALONG_M * self.head[rows])
        return np.asarray(1 - (onward * self.tail[hosts]).sum(axis=1))
