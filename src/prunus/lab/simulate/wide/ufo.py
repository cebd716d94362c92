"""UFO trees far beyond the habits of one orchard, textbook trees among them."""

from __future__ import annotations

import math

import numpy as np

from prunus.lab.simulate.grow import grow_tree
from prunus.lab.simulate.habits import Habits, Range, ufo_habits
from prunus.lab.simulate.wide.settings import UfoRanges, even, happens, log_even
from prunus.model import Skeleton

STRAIGHT_M = (0.001, 0.004)  # the bend of a branch that leaves at once
NEVER_M = (99.0, 99.0)  # a distance beyond every branch


def grow_wide_ufo(rng: np.random.Generator, ranges: UfoRanges) -> Skeleton:
    """A UFO tree with habits of its own, base at the origin."""
    lean = math.radians(even(rng, ranges.plane_lean)) * happens(rng, 0.7)
    return grow_tree(rng, wide_habits(rng, ranges), lean=lean)


def wide_habits(rng: np.random.Generator, ranges: UfoRanges) -> Habits:
    """The habits of one tree: ours, made wilder or tamer, thicker or thinner, barer or furred."""
    ours = ufo_habits()
    wild = 0.0 if happens(rng, ranges.textbook) else even(rng, ranges.wildness)
    stout = log_even(rng, ranges.stout)
    sharp = happens(rng, ranges.sharp)
    changes = {
        "trunk": _trunk(rng, ours, ranges, wild, stout),
        "support": _support(rng, ours, ranges, wild, stout, sharp),
        "leader": _leader(rng, ours, ranges, wild, stout, sharp),
        **_thin_wood(rng, ours, ranges, wild, stout),
    }
    groups = {
        name: getattr(ours, name).model_copy(update=change) for name, change in changes.items()
    }
    return ours.model_copy(update=groups)


def times(limits: Range, factor: float) -> Range:
    """A range, both ends times a factor."""
    return limits[0] * factor, limits[1] * factor


def _around(rng: np.random.Generator, limits: Range, spread: float = 0.15) -> Range:
    """A narrow range about a number drawn from a wide one: what is usual on this tree."""
    middle = even(rng, limits)
    return middle * (1 - spread), middle * (1 + spread)


def _share(share: float, wild: float) -> float:
    return min(1.0, share * wild)


def _trunk(
    rng: np.random.Generator, ours: Habits, ranges: UfoRanges, wild: float, stout: float
) -> dict[str, object]:
    lean = times(ours.trunk.lean, wild)
    if wild > 0 and happens(rng, ranges.leaning):
        lean = times(ranges.trunk_lean, float(rng.choice([-1, 1])))
    return {
        "height": _around(rng, ranges.trunk_height),
        "lean": (min(lean), max(lean)),
        "radius": times(ours.trunk.radius, stout),
    }


def _support(
    rng: np.random.Generator,
    ours: Habits,
    ranges: UfoRanges,
    wild: float,
    stout: float,
    sharp: bool,
) -> dict[str, object]:
    habits = ours.support
    return {
        "length": _around(rng, ranges.support_length),
        "bend": STRAIGHT_M if sharp else times(habits.bend, even(rng, (0.3, 2.5))),
        "wave": times(habits.wave, wild),
        "climb": times(habits.climb, wild),
        "climbing": _share(habits.climbing, wild),
        "swerve": times(habits.swerve, wild),
        "radius": times(habits.radius, stout),
        "ends_upright": even(rng, (0.0, 1.0)),
    }


def _leader(
    rng: np.random.Generator,
    ours: Habits,
    ranges: UfoRanges,
    wild: float,
    stout: float,
    sharp: bool,
) -> dict[str, object]:
    habits = ours.leader
    spacing = even(rng, ranges.leader_spacing)
    rare = ("runs", "crosses", "pairs", "bows", "doubles")
    angles = ("tilt", "wander", "kink")
    return {
        "count": ranges.leaders,
        "spacing": (0.7 * spacing, 1.6 * spacing),
        "tall": _around(rng, ranges.tall, 0.05),
        "bend": STRAIGHT_M if sharp else times(habits.bend, even(rng, (0.3, 2.0))),
        "radius": times(habits.radius, stout),
        "tip_radius": times(habits.tip_radius, min(stout, 1.3)),
        **{name: _share(getattr(habits, name), wild) for name in rare},
        **{name: times(getattr(habits, name), wild) for name in angles},
    }


def _thin_wood(
    rng: np.random.Generator, ours: Habits, ranges: UfoRanges, wild: float, stout: float
) -> dict[str, dict[str, object]]:
    side = ours.side_branch
    thick = min(stout, 1.4)
    bare = happens(rng, ranges.bare)
    apart = log_even(rng, ranges.side_spacing)
    angle = even(rng, ranges.side_angle)
    longest = even(rng, ranges.side_length)
    spurless = happens(rng, ranges.spurless)
    spurs = log_even(rng, ranges.spur_spacing)
    spur = even(rng, ranges.spur_length)
    return {
        "side_branch": {
            "spacing": NEVER_M if bare else (0.5 * apart, 1.5 * apart),
            "first": NEVER_M if bare else side.first,
            "length": (min(0.05, longest), longest),
            "long": _share(side.long, wild),
            "angle": (max(20.0, angle - 15), min(115.0, angle + 15)),
            "depthwise": even(rng, (0.0, 1.0)),
            "curve": times(side.curve, min(wild, 1.0)),
            "forks": _share(side.forks, wild),
            "radius": times(side.radius, thick),
            "upright": _share(side.upright, wild),
        },
        "shoot": {
            "on_support": times(ours.shoot.on_support, wild),
            "on_trunk": times(ours.shoot.on_trunk, wild),
            "radius": times(ours.shoot.radius, thick),
        },
        "spur": {
            "spacing": NEVER_M if spurless else (0.5 * spurs, 1.5 * spurs),
            "length": (min(0.01, spur), spur),
        },
        "stub": {
            "on_support": times(ours.stub.on_support, 0.0 if spurless else wild),
            "on_leader": times(ours.stub.on_leader, 0.0 if spurless else wild),
            "radius": times(ours.stub.radius, thick),
        },
    }
