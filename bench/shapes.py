"""Drawn scans of lone trees of other habits than the simulator grows, and of floors, Z up.

Only what the search for up and for the row needs: where wood is, how thick it is, and how it
hangs together. A tree is a list of straight pieces; a scan has points of their surface.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable

import numpy as np

from prunus.model import Floats

Piece = tuple[Floats, Floats, float]
"""From, to (3,), radius, metres."""
Rng = np.random.Generator
SPACING = 0.006
"""Points of the surface lie about so far apart, metres."""
NOISE = 0.003


def towards(lean: float, azimuth: float) -> Floats:
    """The direction (3,) that leans so many degrees from up, at an azimuth in radians."""
    out = math.sin(math.radians(lean))
    return np.array(
        [out * math.cos(azimuth), out * math.sin(azimuth), math.cos(math.radians(lean))]
    )


def limb(
    rng: Rng, start: Floats, way: Floats, length: float, radius: float, crooked: float = 0.1
) -> list[Piece]:
    """A crooked limb that tapers, in pieces of about 15 cm."""
    pieces, steps = [], max(2, round(length / 0.15))
    for step in range(steps):
        way = way + rng.normal(0, crooked, 3)
        way = way / np.linalg.norm(way)
        end = start + way * length / steps
        pieces.append((start, end, radius * (1 - 0.7 * step / steps)))
        start = end
    return pieces


def trunk_of(rng: Rng, length: tuple[float, float], radius: tuple[float, float]) -> list[Piece]:
    """A trunk that stands at the origin."""
    return limb(rng, np.zeros(3), towards(0, 0), rng.uniform(*length), rng.uniform(*radius), 0.05)


def dressed(
    rng: Rng, bearer: list[Piece], count: int, length: float, lean: tuple[float, float]
) -> list[Piece]:
    """Branches on a limb, at random all round it; longer low down."""
    pieces = []
    for share in rng.uniform(0.15, 1, count):
        start, _, radius = bearer[int(share * (len(bearer) - 1))]
        way = towards(rng.uniform(*lean), rng.uniform(0, 2 * math.pi))
        reach = length * (1.2 - share) * rng.uniform(0.5, 1)
        pieces += limb(rng, start, way, reach, max(0.004, 0.35 * radius))
    return pieces


def spindle(rng: Rng) -> list[Piece]:
    """One upright trunk with short branches all round it, level or nearly so."""
    trunk = trunk_of(rng, (2.2, 3.8), (0.025, 0.06))
    return trunk + dressed(rng, trunk, int(rng.integers(15, 45)), rng.uniform(0.5, 1.1), (55, 110))


def tiered(rng: Rng) -> list[Piece]:
    """An upright trunk with some long level limbs, which bear branches."""
    trunk = trunk_of(rng, (2.5, 4.0), (0.05, 0.09))
    limbs = [
        limb(rng, trunk[int(at)][0], towards(rng.uniform(60, 95), rng.uniform(0, 2 * math.pi)),
             rng.uniform(0.9, 1.6), 0.03)
        for at in rng.uniform(4, len(trunk) - 1, rng.integers(4, 9))
    ]  # fmt: skip
    bare = trunk + list(itertools.chain(*limbs))
    return bare + [x for one in limbs for x in dressed(rng, one, 8, 0.6, (20, 110))]


def vase(rng: Rng) -> list[Piece]:
    """A short trunk and some limbs that lean outward, with branches."""
    trunk = trunk_of(rng, (0.4, 0.8), (0.05, 0.10))
    first, count = rng.uniform(0, 2 * math.pi), rng.integers(3, 6)
    limbs = [
        limb(rng, trunk[-1][1], towards(rng.uniform(25, 50), first + 2 * math.pi * k / count),
             rng.uniform(1.8, 2.8), 0.035)
        for k in range(count)
    ]  # fmt: skip
    bare = trunk + list(itertools.chain(*limbs))
    return bare + [x for one in limbs for x in dressed(rng, one, 12, 0.7, (15, 100))]


def forked(rng: Rng) -> list[Piece]:
    """A trunk and two arms in one plane, as on a Y trellis, with short branches."""
    trunk = trunk_of(rng, (0.4, 0.8), (0.03, 0.06))
    facing, lean = rng.uniform(0, 2 * math.pi), rng.uniform(20, 35)
    arms = [
        limb(rng, trunk[-1][1], towards(lean, facing + turn), rng.uniform(1.8, 2.8), 0.025)
        for turn in (0, math.pi)
    ]
    return (
        trunk
        + arms[0]
        + arms[1]
        + [x for arm in arms for x in dressed(rng, arm, 14, 0.35, (30, 100))]
    )


HABITS: dict[str, Callable[[Rng], list[Piece]]] = {
    "spindle": spindle, "tiered": tiered, "vase": vase, "forked": forked
}  # fmt: skip


def scanned(rng: Rng, pieces: list[Piece], front: bool) -> Floats:
    """Points (P, 3) of the surface, all round or as seen from far along +Y, with noise."""
    xyz = np.concatenate([_surface(rng, *piece) for piece in pieces])
    if front:
        pixel = np.round(xyz[:, [0, 2]] / 0.004).astype(np.int64)
        order = np.lexsort([xyz[:, 1], pixel[:, 1], pixel[:, 0]])
        first = np.ones(len(order), np.bool_)
        first[1:] = (np.diff(pixel[order], axis=0) != 0).any(axis=1)
        xyz = xyz[order[first]]
    return np.asarray(xyz + rng.normal(0, NOISE, xyz.shape))


def _surface(rng: Rng, start: Floats, end: Floats, radius: float) -> Floats:
    axis = end - start
    length = float(np.linalg.norm(axis))
    count = max(4, int(2 * math.pi * radius * length / SPACING**2))
    aside = np.cross(axis / length, [0.0, 0.0, 1.0] if abs(axis[2]) < 0.9 * length else [1.0, 0, 0])
    aside /= np.linalg.norm(aside)
    beside = np.cross(axis / length, aside)
    along, around = rng.random((count, 1)), rng.uniform(0, 2 * math.pi, (count, 1))
    return np.asarray(
        start + along * axis + radius * (np.cos(around) * aside + np.sin(around) * beside)
    )


def with_floor(rng: Rng, xyz: Floats, share: float, side: float = 6.0) -> Floats:
    """The points (P, 3) with a level floor under them that holds so large a share of all."""
    count = round(len(xyz) * share / (1 - share))
    place = (xyz.min(axis=0) + xyz.max(axis=0))[:2] / 2 + rng.uniform(
        -side / 2, side / 2, (count, 2)
    )
    height = xyz[:, 2].min() + rng.normal(0, 0.01, count)
    return np.concatenate([xyz, np.column_stack([place, height])])


def axis_rotations() -> list[Floats]:
    """The 24 rotations (3, 3) that turn axes into axes."""
    found = []
    for order in itertools.permutations(range(3)):
        for signs in itertools.product((1.0, -1.0), repeat=3):
            turn = np.zeros((3, 3))
            turn[range(3), order] = signs
            if np.linalg.det(turn) > 0:
                found.append(turn)
    return found
