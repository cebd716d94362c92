"""A UFO cherry tree from a random generator, as a true skeleton with radii.

Trunk, one or two wavy supports, leaders that leave along the support and bend up, side branches,
the whole plane leaning as in a V trellis (sec. UFO tree description; method.md, last section).
House frame, metres: X along the row, Y depth (cameras stand at smaller Y), Z up, ground at Z = 0.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from prunus.model import Floats, Label, Skeleton

STEP = 0.02
"""Distance of the nodes of a true skeleton, metres."""

Range = tuple[float, float]


@dataclass(frozen=True)
class Habits:
    """Ranges from which every number of a tree is drawn evenly; metres, degrees, counts."""

    trunk_height: Range = (0.35, 0.9)
    trunk_lean: Range = (-12, 12)
    trunk_radius: Range = (0.030, 0.045)
    two_supports: float = 0.6
    support_length: Range = (0.7, 1.6)
    support_wave: Range = (5, 20)
    wave_length: Range = (0.5, 1.2)
    leader_spacing: Range = (0.15, 0.45)
    leader_height: Range = (1.2, 2.0)
    bend_length: Range = (0.10, 0.25)
    kinks: Range = (0, 3)
    kink_angle: Range = (-14, 14)
    v_lean: Range = (0, 35)
    side_spacing: Range = (0.15, 0.6)
    side_length: Range = (0.05, 0.5)
    side_angle: Range = (50, 100)


@dataclass
class _Growing:
    """Rows of the skeleton under construction; leaders stop short of this many metres."""

    rng: np.random.Generator
    habits: Habits
    plane: float
    xyz: list[Floats] = field(default_factory=lambda: [np.zeros(3)])
    parent: list[int] = field(default_factory=lambda: [-1])
    label: list[Label] = field(default_factory=lambda: [Label.TRUNK])
    radius: list[float] = field(default_factory=lambda: [0.0])

    def draw(self, limits: Range) -> float:
        """A number drawn evenly from a range."""
        return float(self.rng.uniform(*limits))

    def branch(self, row: int, label: Label, headings: Floats, radii: Range) -> list[int]:
        """Grow from a row along unit headings (S, 3), one step each, tapering; the new rows."""
        rows = []
        for heading, radius in zip(headings, np.linspace(*radii, len(headings)), strict=True):
            self.xyz.append(self.xyz[row] + STEP * heading)
            self.parent.append(row)
            self.label.append(label)
            self.radius.append(float(radius))
            row = len(self.xyz) - 1
            rows.append(row)
        return rows


def grow_tree(rng: np.random.Generator, habits: Habits | None = None) -> Skeleton:
    """A true skeleton with radii, one node every 2 cm, base at the origin."""
    habits = habits or Habits()
    lean = math.radians(rng.uniform(*habits.v_lean)) * rng.choice([-1, 1])
    tree = _Growing(rng, habits, lean)
    trunk = _grow_trunk(tree)
    first = float(rng.choice([-1, 1]))
    for side in (first, -first)[: 2 if rng.random() < habits.two_supports else 1]:
        support = _grow_support(tree, trunk[-1], side)
        _grow_leaders(tree, trunk[-1], support, side)
    tree.radius[0] = tree.radius[1]
    return Skeleton.build(tree.xyz, tree.parent, tree.label, radius=tree.radius)


def _grow_trunk(tree: _Growing) -> list[int]:
    steps = _steps(tree.draw(tree.habits.trunk_height))
    sideways = math.radians(tree.draw(tree.habits.trunk_lean))
    headings = _upright(np.full(steps, sideways), 0.5 * tree.plane)
    radius = tree.draw(tree.habits.trunk_radius)
    return tree.branch(0, Label.TRUNK, headings, (radius, 0.8 * radius))


def _grow_support(tree: _Growing, top: int, side: float) -> list[int]:
    habits = tree.habits
    along = np.arange(_steps(tree.draw(habits.support_length))) * STEP
    phase = tree.draw((0, 2 * math.pi))
    wave = np.sin(2 * math.pi * along / tree.draw(habits.wave_length) + phase)
    climb = math.radians(tree.draw(habits.support_wave)) * wave
    headings = np.column_stack(
        [side * np.cos(climb), np.sin(climb) * math.sin(tree.plane), np.sin(climb)]
    )
    return tree.branch(top, Label.SUPPORT, _unit(headings), (0.028, 0.016))


def _grow_leaders(tree: _Growing, top: int, support: list[int], side: float) -> None:
    """Leaders along the support, the last one its own end bent up."""
    at = tree.draw((0.05, tree.habits.leader_spacing[1] / 2))
    rows = [top, *support]
    while at < len(support) * STEP:
        row = rows[_steps(at)]
        _grow_leader(tree, row, side)
        at += tree.draw(tree.habits.leader_spacing)
    _grow_leader(tree, support[-1], side)


def _grow_leader(tree: _Growing, row: int, side: float) -> None:
    habits = tree.habits
    steps = _steps(tree.draw(habits.leader_height))
    height = np.arange(steps) * STEP
    sideways = np.zeros(steps)
    for _ in range(round(tree.draw(habits.kinks))):
        tied = height > tree.draw((0.2, height[-1]))
        sideways = np.where(tied, math.radians(tree.draw(habits.kink_angle)), sideways)
    bend = np.exp(-height / (0.4 * tree.draw(habits.bend_length)))
    headings = _upright(_smooth(sideways), tree.plane)
    headings = _unit(headings * (1 - bend)[:, None] + bend[:, None] * [side, 0.0, 0.15])
    leader = tree.branch(row, Label.LEADER, headings, (0.015, 0.005))
    at = tree.draw((0.15, 0.4))
    while at < (steps - 4) * STEP:
        _grow_side_branch(tree, leader[_steps(at)], headings[_steps(at)])
        at += tree.draw(habits.side_spacing)


def _grow_side_branch(tree: _Growing, row: int, leader: Floats) -> None:
    """A shoot at an angle from the leader, more often along the depth than along the row."""
    outward = np.array([tree.rng.normal(0, 0.5), tree.rng.choice([-1.0, 1.0]), 0.0])
    outward = _unit(outward - (outward @ leader) * leader)
    angle = math.radians(tree.draw(tree.habits.side_angle))
    heading = math.cos(angle) * leader + math.sin(angle) * outward
    steps = _steps(tree.draw(tree.habits.side_length))
    rise = np.outer(np.linspace(0, 0.5, steps), [0.0, 0.0, 1.0])
    tree.branch(row, Label.SIDE_BRANCH, _unit(heading + rise), (0.005, 0.003))


def _upright(sideways: Floats, depth: float) -> Floats:
    """Headings (S, 3) that lean sideways (S,) along X and by one angle along Y, radians."""
    return _unit(
        np.column_stack(
            [np.tan(sideways), np.full(len(sideways), math.tan(depth)), np.ones(len(sideways))]
        )
    )


def _smooth(values: Floats, width: int = 5) -> Floats:
    return np.convolve(np.pad(values, width // 2, "edge"), np.full(width, 1 / width), "valid")


def _unit(vectors: Floats) -> Floats:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=-1, keepdims=True))


def _steps(length: float) -> int:
    return max(1, round(length / STEP))
