"""The ranges of the wide orchard, read from the documented `wide.toml`."""

from __future__ import annotations

import math
import tomllib
from functools import cache
from pathlib import Path

import numpy as np

from prunus.lab.simulate.habits import Group, Range


class Growth(Group):
    """Which trees stand where: shares, metres."""

    ufo: float
    standing_alone: float
    spacing: Range
    behind: float
    behind_depth: Range


class UfoRanges(Group):
    """How far the habits of UFO trees are drawn from ours: metres, degrees, shares."""

    textbook: float
    wildness: Range
    stout: Range
    plane_lean: Range
    trunk_height: Range
    leaning: float
    trunk_lean: Range
    sharp: float
    support_length: Range
    leaders: Range
    leader_spacing: Range
    tall: Range
    bare: float
    side_spacing: Range
    side_length: Range
    side_angle: Range
    spurless: float
    spur_spacing: Range
    spur_length: Range


class Form(Group):
    """The architecture of a tree of any form: metres, degrees, shares."""

    share: float
    stem: Range
    limbs: Range
    leaves: Range
    angle: Range
    length: Range
    cone: float
    rise: Range
    flat: Range
    second: Range


class GeneralRanges(Group):
    """Trees of any form: metres, degrees, shares."""

    stout: Range
    taper: Range
    tip_radius: Range
    child_radius: Range
    wander: Range
    twigs: Range
    twig_length: Range
    bare: float
    spurless: float
    spur_spacing: Range
    spur_length: Range
    forms: dict[str, Form]


class Surroundings(Group):
    """What stands around the trees: metres, degrees, shares."""

    ground: float
    ground_slope: Range
    ground_rough: Range
    grass: float
    blades: Range
    blade: Range
    weeds: float
    hidden: Range
    wires: float
    wire_distance: Range
    first_wire: Range
    wire_radius: Range
    sag: Range
    ties: Range
    posts: float
    post_radius: Range
    stake: float
    stake_radius: Range
    stake_height: Range


class Scanner(Group):
    """A scanner: only what it needs is told. Metres, milliradians, millimetres, shares."""

    share: float
    stations: Range = (0, 0)
    distance: Range = (0, 0)
    height: Range = (0, 0)
    resolution: Range = (0, 0)
    noise: Range = (0, 0)
    flying: Range = (0, 0)
    rings: Range = (0, 0)
    missing: Range = (0, 0)
    blur: Range = (0, 0)
    blob: Range = (0, 0)


class Faults(Group):
    """What goes wrong in any scan: counts, millimetres, degrees, shares."""

    points: Range
    noise_mm: Range
    misplaced_mm: Range
    misturned: Range
    holes: Range
    holed: float
    hole: Range
    cut: float
    cut_off: Range
    strays: Range


class WideOrchard(Group):
    """All ranges of `wide.toml`."""

    growth: Growth
    ufo: UfoRanges
    general: GeneralRanges
    around: Surroundings
    scanner: dict[str, Scanner]
    faults: Faults


@cache
def wide_orchard() -> WideOrchard:
    """The ranges that the package ships."""
    path = Path(__file__).with_name("wide.toml")
    return WideOrchard.model_validate(tomllib.loads(path.read_text(encoding="utf-8")))


def even(rng: np.random.Generator, limits: Range) -> float:
    """A number drawn evenly from a range."""
    return float(rng.uniform(*limits))


def log_even(rng: np.random.Generator, limits: Range) -> float:
    """A number drawn from a range, evenly in its logarithm."""
    return math.exp(rng.uniform(math.log(limits[0]), math.log(limits[1])))


def whole(rng: np.random.Generator, limits: Range) -> int:
    """A whole number, both ends of the range in it."""
    return int(rng.integers(int(limits[0]), int(limits[1]) + 1))


def happens(rng: np.random.Generator, share: float) -> bool:
    """Whether something happens that does so in this share of cases."""
    return bool(rng.random() < share)


def chosen(rng: np.random.Generator, shares: dict[str, float]) -> str:
    """One of the names, each as often as its share says."""
    weights = np.array(list(shares.values()))
    return str(rng.choice(list(shares), p=weights / weights.sum()))
