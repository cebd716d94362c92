"""Fruit trees of any form: spindles, vases, Y trellises, palmettes, free trees.

They teach geometry: what wood is, where its axis runs, which way the foot lies. What is stem is
labelled trunk, all else side branch: no other role of a UFO tree is claimed of them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from prunus.geometry.vectors import unit
from prunus.lab.simulate.habits import ufo_habits
from prunus.lab.simulate.wide.settings import (
    Form,
    GeneralRanges,
    chosen,
    even,
    happens,
    log_even,
    whole,
)
from prunus.lab.simulate.wood import STEP, UP, Wood, along
from prunus.model import Floats, Ints, Label, Skeleton

LEAST_M = 0.06  # shorter limbs are spurs
SECOND = (0.25, 0.7)  # length of a limb of the second order, as a share of its parent's


@dataclass(frozen=True, kw_only=True)
class _Plan:
    """What is drawn once a tree."""

    wood: Wood
    form: Form
    ranges: GeneralRanges
    flat: float
    wander: float
    taper: float
    twigs: float
    spurs: float


def grow_general(rng: np.random.Generator, ranges: GeneralRanges) -> Skeleton:
    """A tree of a form drawn at random, base at the origin."""
    form = ranges.forms[chosen(rng, {name: form.share for name, form in ranges.forms.items()})]
    plan = _Plan(
        wood=Wood(rng=rng, habits=ufo_habits(), lean=0.0),
        form=form,
        ranges=ranges,
        flat=even(rng, form.flat),
        wander=math.radians(even(rng, ranges.wander)),
        taper=even(rng, ranges.taper),
        twigs=math.inf if happens(rng, ranges.bare) else log_even(rng, ranges.twigs),
        spurs=math.inf if happens(rng, ranges.spurless) else log_even(rng, ranges.spur_spacing),
    )
    stem = _grow_stem(plan)
    for limb in _grow_limbs(plan, stem):
        for second in _grow_second(plan, limb):
            _dress(plan, second)
        _dress(plan, limb)
    _dress(plan, stem)
    return plan.wood.skeleton()


def _grow_stem(plan: _Plan) -> Ints:
    rng = plan.wood.rng
    length = even(rng, plan.form.stem)
    lean = math.radians(even(rng, (-12, 12))) * np.array([1.0, rng.normal(0, 0.5), 0.0])
    radius = log_even(rng, plan.ranges.stout)
    radii = radius, radius * plan.taper
    return _limb(plan, 0, UP + lean, length, radii, rise=0.0, label=Label.TRUNK)


def _grow_limbs(plan: _Plan, stem: Ints) -> list[Ints]:
    """The limbs of the first order, the lowest first, turning around the stem as they rise."""
    wood, form, rng = plan.wood, plan.form, plan.wood.rng
    count = whole(rng, form.limbs)
    low = even(rng, form.leaves)
    shares = np.sort(rng.uniform(low, 1.0, count))
    turn = rng.uniform(0, 2 * math.pi)
    limbs = []
    for number, share in enumerate(shares):
        row = int(stem[min(round(share * (len(stem) - 1)), len(stem) - 1)])
        azimuth = turn + number * math.radians(137.5) + rng.normal(0, 0.4)
        if rng.random() < plan.flat:
            azimuth = math.pi * ((number % 2) + rng.normal(0, 0.06))
        aside = np.array([math.cos(azimuth), math.sin(azimuth), 0.0])
        angle = math.radians(even(rng, form.angle))
        heading = math.cos(angle) * wood.heading(row) + math.sin(angle) * aside
        shorter = 1 - form.cone * (share - low) / max(1 - low, 1e-6)
        length = max(LEAST_M, even(rng, form.length) * shorter)
        limbs.append(_child(plan, row, heading, length, even(rng, form.rise)))
    return limbs


def _grow_second(plan: _Plan, limb: Ints) -> list[Ints]:
    rng = plan.wood.rng
    length = len(limb) * STEP
    seconds = []
    for _ in range(whole(rng, plan.form.second)):
        row = int(rng.choice(limb[len(limb) // 6 :]))
        reach = length * even(rng, SECOND)
        if reach >= LEAST_M:
            heading = _outward(plan, row, even(rng, (35, 80)))
            seconds.append(_child(plan, row, heading, reach, even(rng, plan.form.rise)))
    return seconds


def _dress(plan: _Plan, rows: Ints) -> None:
    """Twigs and spurs along a limb."""
    rng, ranges = plan.wood.rng, plan.ranges
    for distance, lengths in ((plan.twigs, ranges.twig_length), (plan.spurs, ranges.spur_length)):
        at = even(rng, (0.05, 0.3))
        while at < (len(rows) - 1) * STEP:
            row = int(rows[int(at / STEP)])
            heading = _outward(plan, row, even(rng, (35, 100)))
            _child(plan, row, heading, even(rng, lengths), even(rng, (-0.3, 0.8)))
            at += distance * even(rng, (0.4, 1.6))


def _child(plan: _Plan, row: int, heading: Floats, length: float, rise: float) -> Ints:
    """A limb that is thinner than its parent where it leaves it, and the thinner the shorter."""
    wood, ranges, rng = plan.wood, plan.ranges, plan.wood.rng
    tip = even(rng, ranges.tip_radius)
    usual = even(rng, ranges.child_radius) * wood.radius[row]
    foot = max(min(usual, tip + 0.025 * length), min(tip, 0.9 * wood.radius[row]))
    radii = foot, min(tip, foot)
    return _limb(plan, row, heading, length, radii, rise=rise, label=Label.SIDE_BRANCH)


def _limb(
    plan: _Plan,
    row: int,
    heading: Floats,
    length: float,
    radii: tuple[float, float],
    *,
    rise: float,
    label: Label,
) -> Ints:
    """Grow along a heading that wanders and turns up (rise > 0) or droops over the length."""
    wood = plan.wood
    way = along(length)
    aside = np.column_stack([wood.wander(len(way), plan.wander) for _ in range(3)])
    lift = np.outer(rise * way / max(length, STEP), UP)
    return wood.grow(row, label, unit(heading) + aside + lift, length, radii)


def _outward(plan: _Plan, row: int, angle: float) -> Floats:
    """A heading at an angle, degrees, to the wood at a row, to any side."""
    along_it = plan.wood.heading(row)
    away = plan.wood.rng.normal(size=3) * [1.0, 1.0 - 0.8 * plan.flat, 1.0]
    square = unit(away - (away @ along_it) * along_it)
    turn = math.radians(angle)
    return np.asarray(math.cos(turn) * along_it + math.sin(turn) * square)
