"""Thin wood: side branches, upright shoots, spurs, and the stubs that old cuts left."""

from __future__ import annotations

import math

import numpy as np

from prunus.geometry.vectors import unit
from prunus.lab.simulate.wood import STEP, UP, Wood, along, blended
from prunus.model import Floats, Ints, Label

TIP = 0.6
"""Radius of thin wood at its end, as a share of that at its foot."""


def grow_leader_shoots(wood: Wood, leader: Ints) -> None:
    """Side branches, spurs, stubs and now and then an upright shoot on a leader (S rows)."""
    habits = wood.habits.side_branch
    length = len(leader) * STEP
    at = wood.draw(habits.first)
    while at < length - 0.06:
        _side_branch(wood, int(leader[round(at / STEP)]))
        at += wood.draw(habits.spacing)
    if wood.happens(habits.upright) and length > 0.6:
        start = wood.rng.integers(len(leader) // 8, len(leader) // 2)
        left = (len(leader) - start) * STEP
        _upright_shoot(wood, int(leader[start]), left * wood.draw((0.7, 1.05)), habits.radius)
    _spurs(wood, leader)
    _stubs(wood, leader, wood.count(wood.habits.stub.on_leader))


def grow_support_shoots(wood: Wood, support: Ints, tall: float) -> None:
    """Shoots, spurs and stubs on a support; some shoots as tall as the leaders."""
    for row in wood.rng.choice(support, wood.count(wood.habits.shoot.on_support)):
        _shoot(wood, int(row), tall)
    _spurs(wood, support)
    _stubs(wood, support, wood.count(wood.habits.stub.on_support))


def grow_trunk_shoots(wood: Wood, trunk: Ints) -> None:
    """Shoots on the trunk."""
    for row in wood.rng.choice(trunk, wood.count(wood.habits.shoot.on_trunk)):
        _shoot(wood, int(row), 0.0)


def _shoot(wood: Wood, row: int, tall: float) -> None:
    habits = wood.habits.shoot
    if tall and wood.happens(habits.tall):
        length = max(0.3, (tall - wood.xyz[row, 2]) * wood.draw((0.6, 1.0)))
        _upright_shoot(wood, row, length, habits.radius)
    else:
        outward = unit(_outward(wood, row) + UP * wood.draw((-0.2, 1.5)))
        _twig(wood, row, outward, wood.draw(habits.length), habits.radius)


def _side_branch(wood: Wood, row: int) -> None:
    """A branch at an angle to its leader, drooping or rising, now and then forked."""
    habits = wood.habits.side_branch
    angle = wood.angle(habits.angle)
    heading = math.cos(angle) * wood.heading(row) + math.sin(angle) * _outward(wood, row)
    length = wood.draw(habits.long_length if wood.happens(habits.long) else habits.length)
    rows = _twig(wood, row, heading, length, habits.radius)
    if len(rows) > 6 and wood.happens(habits.forks):
        foot = int(wood.rng.choice(rows[2:-3]))
        aside = unit(wood.heading(foot) + 0.7 * _outward(wood, foot))
        _twig(wood, foot, aside, length * wood.draw((0.3, 0.6)), habits.radius)


def _twig(
    wood: Wood, row: int, heading: Floats, length: float, radius: tuple[float, float]
) -> Ints:
    """A twig that starts along a heading and curves down or up."""
    habits = wood.habits.side_branch
    way = along(length)
    curve = wood.angle(habits.curve) * (-1 if wood.happens(habits.droops) else 1)
    rise = np.tan(curve * way / max(length, STEP)) * math.hypot(heading[0], heading[1])
    aside = np.column_stack([wood.wander(len(way), 0.12) for _ in range(3)])
    foot = min(wood.draw(radius), 0.9 * wood.radius[row])
    return wood.grow(
        row, Label.SIDE_BRANCH, heading + aside + np.outer(rise, UP), length, (foot, TIP * foot)
    )


def _upright_shoot(wood: Wood, row: int, length: float, radius: tuple[float, float]) -> None:
    """A shoot that leaves sideways, turns up, and grows beside the leaders."""
    way = along(length)
    lean = np.array([0.0, math.tan(wood.lean), 0.0])
    wander = np.column_stack([wood.wander(len(way), 0.08) for _ in range(3)])
    rising = unit(UP + lean + wander + 0.15 * wood.rng.normal(size=3) * [1, 1, 0])
    bend = 1.6 * wood.draw(wood.habits.side_branch.upright_bend)
    headings = blended(_outward(wood, row), rising, 0.2 + way / bend)
    foot = wood.draw(radius)
    wood.grow(row, Label.SIDE_BRANCH, headings, length, (foot, TIP * foot))


def _spurs(wood: Wood, rows: Ints) -> None:
    habits = wood.habits.spur
    at = wood.draw(habits.spacing)
    while at < (len(rows) - 2) * STEP:
        row = int(rows[round(at / STEP)])
        _nub(wood, row, wood.draw(habits.length), wood.draw(habits.radius))
        at += wood.draw(habits.spacing)


def _stubs(wood: Wood, rows: Ints, count: int) -> None:
    for row in wood.rng.choice(rows, count):
        _nub(wood, int(row), wood.draw(wood.habits.stub.length), wood.draw(wood.habits.stub.radius))


def _nub(wood: Wood, row: int, length: float, radius: float) -> None:
    """A short straight piece of even radius, outward and a little up."""
    heading = unit(_outward(wood, row) + UP * wood.draw((0.0, 0.8)))
    wood.grow(row, Label.SIDE_BRANCH, np.tile(heading, (len(along(length)), 1)), length,
              (radius, radius))  # fmt: skip


def _outward(wood: Wood, row: int) -> Floats:
    """A direction (3,) square to the wood at a row, more often along the depth."""
    habits = wood.habits.side_branch
    if wood.happens(habits.depthwise):
        away = np.array([wood.rng.normal(0, 0.35), wood.side(), wood.rng.normal(0, 0.2)])
    else:
        away = wood.rng.normal(size=3)
    heading = wood.heading(row)
    return unit(away - (away @ heading) * heading)
