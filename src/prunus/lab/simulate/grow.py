"""A UFO cherry tree from a random generator, as a true skeleton with radii.

Trunk, one or two wavy supports, leaders that leave along the support and bend up, the whole plane
leaning as in a V trellis (sec. UFO tree description; docs/simulation.md). Every number comes
from `habits.toml`, the habits that break the method among them; thin wood is in `shoots`.
House frame, metres: X along the row, Y depth (cameras stand at smaller Y), Z up, ground at Z = 0.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from prunus.lab.simulate.habits import Habits, ufo_habits
from prunus.lab.simulate.shoots import (
    grow_leader_shoots,
    grow_support_shoots,
    grow_trunk_shoots,
)
from prunus.lab.simulate.wood import STEP, Wood, along, blended, smoothed, upright
from prunus.model import Floats, Ints, Label, Skeleton


def grow_tree(
    rng: np.random.Generator,
    habits: Habits | None = None,
    lean: float = 0.0,
    sides: tuple[float, ...] = (),
    room: float = math.inf,
) -> Skeleton:
    """A true skeleton with radii, a node every 2 cm, base at the origin.

    `lean` is that of the tree's plane from upright towards greater Y, radians. `sides` (-1, 1 or
    both) are where supports grow, drawn when none is given; together they fill at most `room`,
    metres. Shoots on trunk and supports are labelled side branches; these and leaders may fork.
    """
    wood = Wood(rng=rng, habits=habits or ufo_habits(), lean=lean)
    tall = wood.draw(wood.habits.leader.tall)
    trunk = _grow_trunk(wood)
    arms = _grow_supports(wood, int(trunk[-1]), sides or draw_sides(rng, wood.habits), room)
    for arm in arms:
        for row in _leader_feet(wood, arm):
            _grow_leader(wood, row, arm.side, tall)
        grow_support_shoots(wood, arm.rows, tall)
    grow_trunk_shoots(wood, trunk)
    return wood.skeleton()


@dataclass(frozen=True, eq=False)
class _Arm:
    """A support: its rows (S,), the trunk's top first; where it points; leaders it carries."""

    rows: Ints
    side: float
    leaders: int


def _grow_trunk(wood: Wood) -> Ints:
    habits = wood.habits.trunk
    length = wood.draw(habits.height)
    steps = len(along(length))
    sideways = wood.angle(habits.lean) + wood.wander(steps, math.radians(4))
    depth = 0.5 * wood.lean + wood.wander(steps, math.radians(3))
    radius = wood.draw(habits.radius)
    radii = (radius, radius * wood.draw(habits.taper))
    return wood.grow(0, Label.TRUNK, upright(sideways, depth), length, radii)


def draw_sides(rng: np.random.Generator, habits: Habits) -> tuple[float, ...]:
    """Where the supports of a tree grow: to one side, or to both."""
    first = float(rng.choice([-1.0, 1.0]))
    return (first, -first) if rng.random() < habits.support.two else (first,)


def _grow_supports(wood: Wood, top: int, sides: tuple[float, ...], room: float) -> list[_Arm]:
    """One arm or two, long enough for their leaders at the closest spacing."""
    habits = wood.habits
    leaders = wood.count(habits.leader.count)
    least = leaders * habits.leader.spacing[0] / len(sides)
    lengths = [max(least, wood.draw(habits.support.length)) for _ in sides]
    shrink = min(1.0, room / sum(lengths))
    lengths = [shrink * length for length in lengths]
    arms = []
    for side, length in zip(sides, lengths, strict=True):
        rows = _grow_support(wood, top, side, length)
        share = round(leaders * length / sum(lengths))
        arms.append(_Arm(np.concatenate([[top], rows]), side, max(1, share)))
    return arms


def _grow_support(wood: Wood, top: int, side: float, length: float) -> Ints:
    habits = wood.habits.support
    way = along(length)
    phase, wave = wood.draw((0, 2 * math.pi)), wood.draw(habits.wave_length)
    steepest = 2 * math.pi / wave * wood.draw(habits.wave)
    steep = wood.happens(habits.climbing)
    mean = wood.angle(habits.steep_climb if steep else habits.climb)
    climb = mean + np.arctan(steepest * np.sin(2 * math.pi * way / wave + phase))
    climb += wood.wander(len(way), math.radians(4))
    swerve = wood.angle(habits.swerve) + wood.wander(len(way), math.radians(3))
    level = np.column_stack(
        [
            side * np.cos(climb) * np.cos(swerve),
            np.sin(climb) * math.tan(wood.lean) + np.cos(climb) * np.sin(swerve),
            np.sin(climb),
        ]
    )
    headings = blended(wood.heading(top), level, way / wood.draw(habits.bend))
    radius = wood.draw(habits.radius)
    return wood.grow(
        top, Label.SUPPORT, headings, length, (radius, radius * wood.draw(habits.taper))
    )


def _leader_feet(wood: Wood, arm: _Arm) -> list[int]:
    """Rows of the support where leaders leave, some in pairs; the last is often its own end."""
    habits = wood.habits.leader
    length = (len(arm.rows) - 1) * STEP
    spacing = float(np.clip(length / arm.leaders, *habits.spacing))
    feet = []
    at = wood.draw((0.03, spacing))
    while at < length - 0.05:
        feet.append(at)
        if wood.happens(habits.pairs):
            feet.append(at + wood.draw(habits.pair_spacing))
        at += max(habits.spacing[0], spacing * wood.draw((0.7, 1.3)))
    if wood.happens(wood.habits.support.ends_upright):
        feet = [foot for foot in feet if foot < length - 0.08] + [length]
    return [int(arm.rows[min(round(foot / STEP), len(arm.rows) - 1)]) for foot in feet]


def _grow_leader(wood: Wood, row: int, side: float, tall: float) -> None:
    habits = wood.habits.leader
    run = wood.draw(habits.run) if wood.happens(habits.runs) else 0.0
    length = max(habits.shortest, tall * wood.draw(habits.uneven) - wood.xyz[row, 2]) + run
    way = along(length)
    rising = upright(_sideways(wood, way), _depth(wood, way - run, length - run))
    climb = wood.angle((0, 15))
    level = np.array([side * math.cos(climb), 0.0, math.sin(climb)])
    headings = blended(level, rising, (way - run) / (1.6 * wood.draw(habits.bend)))
    radii = (wood.draw(habits.radius), wood.draw(habits.tip_radius))
    leader = wood.grow(row, Label.LEADER, headings, length, radii)
    grow_leader_shoots(wood, leader)
    if wood.happens(habits.doubles):
        _fork_leader(wood, leader, headings, wood.draw(habits.double_height))


def _sideways(wood: Wood, way: Floats) -> Floats:
    """The angle (S,) of a leader from upright along the row: tilt, wandering, ties, a bow."""
    habits = wood.habits.leader
    crosses = wood.happens(habits.crosses)
    tilt = wood.side() * wood.angle(habits.crossing_tilt) if crosses else wood.angle(habits.tilt)
    kinks = np.zeros(len(way))
    tie, distance = wood.draw((0.1, 0.5)), wood.draw(habits.ties)
    while tie < way[-1]:
        kinks = np.where(way > tie, wood.angle(habits.kink), kinks)
        tie += distance
    bow = np.zeros(len(way))
    if wood.happens(habits.bows):
        span = wood.draw(habits.bow_length)
        out = (way - wood.draw((0.1, max(0.2, way[-1] - span)))) / span
        out = np.where((out > 0) & (out < 1), np.sin(2 * math.pi * out), 0.0)
        bow = wood.side() * wood.angle(habits.bow) * out
    wander = wood.wander(len(way), wood.angle(habits.wander))
    return np.asarray(np.clip(smoothed(tilt + kinks + bow) + wander, -1.2, 1.2))


def _depth(wood: Wood, risen: Floats, length: float) -> Floats:
    """The angle (S,) of a leader from upright along the depth: the plane's, less so higher up."""
    habits = wood.habits.leader
    top = wood.draw(habits.straighter)
    share = np.clip(risen / max(length, STEP), 0, 1)
    wander = wood.wander(len(risen), math.radians(3), 0.4)
    return np.asarray(wood.lean * (1.15 - (1.15 - top) * share) + wander)


def _fork_leader(wood: Wood, leader: Ints, headings: Floats, at: float) -> None:
    """A second arm that leaves at an angle, and bends back to run beside the first."""
    start = round(at / STEP)
    if start + 15 >= len(leader):
        return
    away = wood.side() * wood.angle(wood.habits.leader.double_angle)
    rest = headings[start:]
    turned = rest + np.tan(away) * np.array([1.0, wood.rng.normal(0, 0.3), 0.0])
    back = blended(turned, rest, along(len(rest) * STEP)[: len(rest)] / wood.draw((0.1, 0.4)))
    radius = 0.8 * wood.radius[leader[start]]
    length = len(rest) * STEP * wood.draw((0.6, 1.0))
    rows = wood.grow(
        int(leader[start]), Label.LEADER, back[: len(along(length))], length,
        (radius, wood.draw(wood.habits.leader.tip_radius)),
    )  # fmt: skip
    grow_leader_shoots(wood, rows)
