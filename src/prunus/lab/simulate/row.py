"""An orchard row around one tree: neighbours, the arm behind, wires, ties, posts, grass.

A V trellis has one row of trunks, trained to either arm in turn; the target is a tree of the arm
in front or, seldom, of one that leans away.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from prunus.lab.simulate.grow import draw_sides, grow_tree
from prunus.lab.simulate.habits import Habits
from prunus.lab.simulate.settings import RowSettings
from prunus.model import Floats, Ints, Kind, Label, RigidMotion, Skeleton

NONE = -1
"""No tree, no row of a tree."""


@dataclass(frozen=True, eq=False)
class Pieces:
    """Round pieces from start to end (S, 3), radius (S,), kind (S,), tree and its row (S,)."""

    start: Floats
    end: Floats
    radius: Floats
    kind: Ints
    tree: Ints
    row: Ints

    @classmethod
    def joined(cls, parts: list[Pieces]) -> Pieces:
        """All pieces of the parts, in order."""
        fields = ("start", "end", "radius", "kind", "tree", "row")
        return cls(*(np.concatenate([getattr(part, name) for part in parts]) for name in fields))

    @classmethod
    def things(cls, start: Floats, end: Floats, radius: float, kind: Kind) -> Pieces:
        """Pieces that belong to no tree."""
        none = np.full(len(start), NONE)
        return cls(start, end, np.full(len(start), radius), np.full(len(start), kind), none, none)


@dataclass(frozen=True, eq=False)
class Row:
    """True trees (the target first), and all pieces that a camera can see."""

    trees: list[Skeleton]
    pieces: Pieces


def plant_row(rng: np.random.Generator, settings: RowSettings, habits: Habits) -> Row:
    """A row from a random generator: the target's trunk meets the ground at the origin."""
    side = -1.0 if rng.random() < settings.towards else 1.0
    low, high = settings.lean
    lean = side * math.radians(rng.triangular(low, (low + high) / 2, high))
    spacing = rng.uniform(*settings.spacing)
    sides = draw_sides(rng, habits)
    trees: list[Skeleton] = []
    parts: list[Pieces] = []
    for kind, arm, at in _places(rng, settings, spacing):
        angle = arm * lean + math.radians(rng.uniform(*settings.lean_varies))
        like = sides if rng.random() < settings.alike else ()
        room = spacing * rng.uniform(*settings.room) if spacing else math.inf
        grown = grow_tree(rng, habits, lean=angle, sides=like, room=room)
        tree = grown.moved(RigidMotion(np.eye(3), at))
        parts.append(wood_of(tree, kind, len(trees)))
        trees.append(tree)
    for angle, depth in ((lean, 0.0), (-lean, float(np.mean(settings.behind_depth)))):
        parts += _trellis(rng, settings, trees, angle, depth)
    if rng.random() < settings.post:
        parts.append(_post(rng, settings))
    parts.append(_grass(rng, settings))
    return Row(trees, Pieces.joined(parts))


def _places(
    rng: np.random.Generator, settings: RowSettings, spacing: float
) -> Iterator[tuple[Kind, float, Floats]]:
    """Kind, arm of the V (1 the target's, -1 the other) and foot (3,) of each tree."""
    yield Kind.TARGET, 1.0, np.zeros(3)
    if spacing == 0:
        return
    for step in (-1, 1):
        yield Kind.NEIGHBOUR, 1.0, _shifted(rng, settings, step * spacing, 0.0)
    if rng.random() < settings.behind:
        depth, halfway = rng.uniform(*settings.behind_depth), rng.uniform(0.35, 0.65)
        for step in (-2, -1, 0, 1):
            yield Kind.BEHIND, -1.0, _shifted(rng, settings, (step + halfway) * spacing, depth)


def _shifted(rng: np.random.Generator, settings: RowSettings, along: float, depth: float) -> Floats:
    away = rng.uniform(*settings.shift, 2)
    return np.array([along + away[0], depth + away[1], 0.0])


def wood_of(tree: Skeleton, kind: Kind, number: int) -> Pieces:
    """The pieces of a tree: one an edge."""
    rows = np.arange(1, len(tree))
    size = len(rows)
    return Pieces(
        tree.xyz[tree.parent[rows]], tree.xyz[rows], tree.radius[rows],
        np.full(size, kind), np.full(size, number), rows,
    )  # fmt: skip


def _trellis(
    rng: np.random.Generator,
    settings: RowSettings,
    trees: list[Skeleton],
    lean: float,
    depth: float,
) -> Iterator[Pieces]:
    """The wires of one arm, and the ties where leaders cross them."""
    if settings.wires[1] == 0:
        return
    height, distance = rng.uniform(*settings.first_wire), rng.uniform(*settings.wires)
    x = np.linspace(-3.5, 3.5, 141)
    while height < 2.8:
        wave = (x - rng.uniform(-1, 1)) ** 2 / 12.25
        sag = rng.uniform(*settings.wire_sag) * wave
        y = depth + height * math.tan(lean) + rng.normal(0, 0.03) + 0 * x
        wire = np.column_stack([x, y, height + sag + rng.uniform(-0.02, 0.02) * x])
        yield Pieces.things(wire[:-1], wire[1:], rng.uniform(*settings.wire_radius), Kind.WIRE)
        yield _ties(rng, settings, trees, wire)
        height += distance


def _ties(
    rng: np.random.Generator, settings: RowSettings, trees: list[Skeleton], wire: Floats
) -> Pieces:
    """Ties: short thick pieces around leaders within a hand of the wire."""
    knots: list[Floats] = []
    for tree in trees:
        leaders = tree.xyz[tree.edges_with(Label.LEADER)]
        level = np.interp(leaders[:, 0], wire[:, 0], wire[:, 2])
        near = np.abs(leaders[:, 2] - level) < 0.01
        near &= np.abs(leaders[:, 1] - wire[0, 1]) < 0.10
        knots += [knot for knot in leaders[near] if rng.random() < settings.tied]
    ties = np.array(knots).reshape(-1, 3)
    across = rng.normal(0, 0.02, ties.shape)
    return Pieces.things(ties - across, ties + across, 0.008, Kind.WIRE)


def _post(rng: np.random.Generator, settings: RowSettings) -> Pieces:
    at = np.array([rng.uniform(-1.8, 1.8), rng.uniform(-0.25, 0.4), 0.0])
    lean = np.array([rng.normal(0, 0.03), rng.normal(0, 0.1), 1.0])
    z = np.linspace(0, 3, 61)[:, None]
    path = at + z * lean
    return Pieces.things(path[:-1], path[1:], rng.uniform(*settings.post_radius), Kind.POST)


def _grass(rng: np.random.Generator, settings: RowSettings) -> Pieces:
    """Tufts of a few blades in the alley before the trunks."""
    tufts = round(rng.uniform(*settings.tufts))
    foot = np.column_stack([rng.uniform(-2, 2, tufts), rng.uniform(-1.6, -0.3, tufts)])
    blades = np.repeat(foot, 4, axis=0) + rng.normal(0, 0.02, (4 * tufts, 2))
    height = rng.uniform(*settings.blade, 4 * tufts)[:, None] if tufts else np.zeros((0, 1))
    start = np.column_stack([blades, np.zeros(len(blades))])
    end = start + height * np.column_stack(
        [rng.normal(0, 0.5, (len(blades), 2)), np.ones(len(blades))]
    )
    return Pieces.things(start, end, 0.003, Kind.GROUND)
