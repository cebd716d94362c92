"""Wood under construction: rows of a skeleton, and the drawing of numbers and shapes."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from prunus.geometry.vectors import unit
from prunus.lab.simulate.habits import Habits, Range
from prunus.model import Floats, Ints, Label, Skeleton

STEP = 0.02
"""Longest distance of the nodes of a true skeleton, metres."""

UP = np.array([0.0, 0.0, 1.0])


@dataclass(kw_only=True)
class Wood:
    """The rows grown so far. `lean` is that of the plane of the tree towards greater Y, radians."""

    rng: np.random.Generator
    habits: Habits
    lean: float
    xyz: Floats = field(default_factory=lambda: np.zeros((1, 3)))
    parent: Ints = field(default_factory=lambda: np.full(1, -1))
    label: Ints = field(default_factory=lambda: np.full(1, int(Label.TRUNK)))
    radius: Floats = field(default_factory=lambda: np.zeros(1))

    def draw(self, limits: Range) -> float:
        """A number drawn evenly from a range."""
        return float(self.rng.uniform(*limits))

    def angle(self, limits: Range) -> float:
        """The same of a range in degrees, in radians."""
        return math.radians(self.draw(limits))

    def count(self, limits: Range) -> int:
        """A whole number, both ends of the range in it."""
        return int(self.rng.integers(int(limits[0]), int(limits[1]) + 1))

    def happens(self, share: float) -> bool:
        """Whether something happens that does so in this share of cases."""
        return bool(self.rng.random() < share)

    def side(self) -> float:
        """One side or the other: -1 or 1."""
        return float(self.rng.choice([-1.0, 1.0]))

    def wander(self, steps: int, deviation: float, smooth: float = 0.25) -> Floats:
        """Values (S,) that wander slowly around 0, smooth over that many metres."""
        width = 2 * round(smooth / STEP / 2) + 1
        noise = np.convolve(self.rng.normal(size=steps + 2 * width), np.hanning(width), "same")
        noise = noise[width : width + steps]
        return np.asarray(deviation * noise / math.sqrt((np.hanning(width) ** 2).sum()))

    def grow(self, row: int, label: Label, headings: Floats, length: float, radii: Range) -> Ints:
        """Grow from a row along headings (S, 3), tapering evenly; the new rows (S,)."""
        steps = len(headings)
        rows = len(self.xyz) + np.arange(steps)
        way = np.cumsum(unit(headings), axis=0) * (length / steps)
        self.xyz = np.concatenate([self.xyz, self.xyz[row] + way])
        self.parent = np.concatenate([self.parent, [row], rows[:-1]])
        self.label = np.concatenate([self.label, np.full(steps, int(label))])
        self.radius = np.concatenate([self.radius, np.linspace(*radii, steps)])
        return rows

    def heading(self, row: int) -> Floats:
        """The direction (3,) in which the wood reaches a row."""
        return unit(self.xyz[row] - self.xyz[self.parent[row]])

    def skeleton(self) -> Skeleton:
        """The true skeleton, base at the origin."""
        radius = np.concatenate([self.radius[1:2], self.radius[1:]])
        return Skeleton.build(self.xyz, self.parent, self.label, radius=radius)


def steps_of(length: float) -> int:
    """How many steps make a length."""
    return max(1, math.ceil(length / STEP - 1e-9))


def along(length: float) -> Floats:
    """Way (S,) from the start at each step of a branch."""
    return np.asarray(np.arange(steps_of(length)) * STEP)


def upright(sideways: Floats, depth: Floats) -> Floats:
    """Headings (S, 3) that lean along X and along Y by angles (S,) from upright, radians."""
    return unit(np.column_stack([np.tan(sideways), np.tan(depth), np.ones(len(sideways))]))


def blended(first: Floats, second: Floats, share: Floats) -> Floats:
    """Headings (S, 3) that turn from the first to the second as the share (S,) goes 0 to 1."""
    share = np.clip(share, 0, 1)[:, None]
    share = share * share * (3 - 2 * share)
    return unit(first * (1 - share) + second * share)


def smoothed(values: Floats, width: int = 5) -> Floats:
    """The running mean of values (S,)."""
    padded = np.pad(values, width // 2, "edge")
    return np.convolve(padded, np.full(width, 1 / width), "valid")
