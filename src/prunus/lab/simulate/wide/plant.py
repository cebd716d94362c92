"""What stands in view: the tree, its neighbours, the row behind, ground, grass, wires, posts.

House frame, metres: X along the row, Y depth (a viewer stands at smaller Y), Z up, the target's
foot at the origin.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from prunus.lab.simulate.row import Pieces, Row, wood_of
from prunus.lab.simulate.wide.general import grow_general
from prunus.lab.simulate.wide.settings import Surroundings, WideOrchard, even, happens, whole
from prunus.lab.simulate.wide.ufo import grow_wide_ufo
from prunus.model import Floats, Kind, RigidMotion, Skeleton

WIRE_STEPS = 61
POST_M = (1.5, 3.6)  # height of a post


def plant_wide(rng: np.random.Generator, orchard: WideOrchard) -> Row:
    """A row from a random generator; ground is drawn apart, see `ground_points`."""
    growth = orchard.growth
    system = happens(rng, growth.ufo)
    trees: list[Skeleton] = []
    parts: list[Pieces] = []
    for kind, place in _places(rng, orchard):
        # A row is of one system; each of its trees has habits of its own.
        grown = grow_wide_ufo(rng, orchard.ufo) if system else grow_general(rng, orchard.general)
        tree = grown.moved(RigidMotion(np.eye(3), place))
        parts.append(wood_of(tree, kind, len(trees)))
        trees.append(tree)
    parts += _things(rng, orchard.around, trees)
    return Row(trees, Pieces.joined(parts))


def _places(rng: np.random.Generator, orchard: WideOrchard) -> Iterator[tuple[Kind, Floats]]:
    growth = orchard.growth
    yield Kind.TARGET, np.zeros(3)
    if happens(rng, growth.standing_alone):
        return
    spacing = even(rng, growth.spacing)
    for step in (-1, 1):
        yield Kind.NEIGHBOUR, np.array([step * spacing, 0.0, 0.0]) + _shift(rng)
    if happens(rng, growth.behind):
        depth, start = even(rng, growth.behind_depth), rng.uniform(-1, 0)
        for step in range(-1, 3):
            yield Kind.BEHIND, np.array([(start + step) * spacing, depth, 0.0]) + _shift(rng)


def _shift(rng: np.random.Generator) -> Floats:
    return np.append(rng.normal(0, 0.06, 2), 0.0)


def _things(
    rng: np.random.Generator, around: Surroundings, trees: list[Skeleton]
) -> Iterator[Pieces]:
    if happens(rng, around.wires):
        yield from _wires(rng, around, trees)
    if happens(rng, around.posts):
        foot = np.array([rng.uniform(-2.0, 2.0), rng.normal(0, 0.2), 0.0])
        yield _upright(rng, foot, even(rng, POST_M), even(rng, around.post_radius), 0.04)
    if happens(rng, around.stake):
        beside = trees[0].xyz[0] + np.append(rng.choice([-1, 1], 2) * rng.uniform(0.03, 0.15, 2), 0)
        height, radius = even(rng, around.stake_height), even(rng, around.stake_radius)
        yield _upright(rng, beside, height, radius, 0.03)
    if happens(rng, around.grass):
        yield _grass(rng, around, trees[0])


def _upright(
    rng: np.random.Generator, foot: Floats, height: float, radius: float, askew: float
) -> Pieces:
    """A straight post from below the ground, a little askew."""
    lean = np.append(rng.normal(0, askew, 2), 1.0)
    path = foot + np.linspace(-0.1, height, max(2, round(height / 0.05)))[:, None] * lean
    return Pieces.things(path[:-1], path[1:], radius, Kind.POST)


def _wires(
    rng: np.random.Generator, around: Surroundings, trees: list[Skeleton]
) -> Iterator[Pieces]:
    """Wires in the plane of the target, and ties where wood crosses them."""
    wood = trees[0].xyz
    top = float(wood[:, 2].max())
    height, distance = even(rng, around.first_wire), even(rng, around.wire_distance)
    lean = float(np.polyfit(wood[:, 2], wood[:, 1], 1)[0]) if len(wood) > 2 else 0.0
    tied = even(rng, around.ties)
    x = np.linspace(-4, 4, WIRE_STEPS)
    while height < top:
        sag = even(rng, around.sag) * (x / 4) ** 2
        slope = rng.uniform(-0.02, 0.02)
        beside = lean * height + rng.normal(0, 0.04)
        wire = np.column_stack([x, np.full_like(x, beside), height + sag + slope * x])
        yield Pieces.things(wire[:-1], wire[1:], even(rng, around.wire_radius), Kind.WIRE)
        yield _ties(rng, trees, wire, tied)
        height += distance


def _ties(rng: np.random.Generator, trees: list[Skeleton], wire: Floats, share: float) -> Pieces:
    nodes = np.concatenate([tree.xyz for tree in trees])
    level = np.interp(nodes[:, 0], wire[:, 0], wire[:, 2])
    near = (np.abs(nodes[:, 2] - level) < 0.01) & (np.abs(nodes[:, 1] - wire[0, 1]) < 0.08)
    knots = nodes[near][rng.random(near.sum()) < share]
    across = rng.normal(0, 0.02, knots.shape)
    return Pieces.things(knots - across, knots + across, 0.008, Kind.WIRE)


def _grass(rng: np.random.Generator, around: Surroundings, tree: Skeleton) -> Pieces:
    low, high = tree.xyz[:, :2].min(axis=0) - 0.6, tree.xyz[:, :2].max(axis=0) + 0.6
    count = whole(rng, around.blades)
    tufts = rng.uniform(low, high, (max(1, count // 8), 2))
    feet = tufts[rng.integers(len(tufts), size=count)] + rng.normal(0, 0.03, (count, 2))
    height = rng.uniform(0.02, even(rng, around.blade), (count, 1))
    start = np.column_stack([feet, np.zeros(count)])
    leans = np.column_stack([rng.normal(0, 0.5, (count, 2)), np.ones(count)])
    return Pieces.things(start, start + height * leans, 0.002, Kind.GROUND)


def ground_points(
    rng: np.random.Generator, around: Surroundings, row: Row, spacing: float
) -> Floats:
    """Points (G, 3) of a rough, sloping ground about the trees; none where it is not in view."""
    if not happens(rng, around.ground):
        return np.zeros((0, 3))
    feet = np.concatenate([tree.xyz[:, :2] for tree in row.trees])
    reach = rng.uniform(0.2, 1.5, 2)
    low, high = feet.min(axis=0) - reach, feet.max(axis=0) + reach
    count = int(min(400_000, np.prod(high - low) / spacing**2))
    at = rng.uniform(low, high, (count, 2))
    slope = np.tan(np.radians(rng.uniform(*around.ground_slope, 2)))
    rough = even(rng, around.ground_rough)
    bumps = sum(
        rough * np.sin(at @ rng.normal(0, 6, 2) + rng.uniform(0, 2 * math.pi)) for _ in range(4)
    )
    height = at @ slope + bumps + rng.normal(0, 0.3 * rough, count)
    return np.column_stack([at, height])
