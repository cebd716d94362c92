"""Textbook UFO trees, straight as a drawing has them, and two scans of each: no habits, no bends.

Trunk, two level supports of 1.2 m, four upright leaders on each, five side branches a leader.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.spatial import cKDTree

from prunus.lab.simulate.habits import Range, ufo_habits
from prunus.lab.simulate.row import NONE, Pieces, Row, wood_of
from prunus.lab.simulate.scan import Scan
from prunus.lab.simulate.wide.surface import Surface, sample_pieces, seen_from
from prunus.lab.simulate.wood import STEP, UP, Wood
from prunus.model import Bools, Floats, Ints, Kind, Label, Skeleton

POINTS = 50_000
SUPPORT_M, LEADERS, SIDES = 1.2, 4, 5
SPACING_M = 0.0018  # distance of surface samples
ROUND_NOISE_M, SIDE_NOISE_M = 0.001, 0.004
CAMERA = np.array([0.0, -2.2, 1.4])
PIXEL_RAD = 0.0012
HOLES, HOLE_M = 25, (0.03, 0.08)
WIRE_HEIGHTS_M, WIRE_RADIUS_M = (1.15, 1.85), 0.0015
STRAYS = 0.003  # share of all points
Rng = np.random.Generator


def straight_ufo(rng: Rng) -> Skeleton:
    """A tree of straight limbs, a node every 2 cm at most, base at the origin."""
    wood = Wood(rng=rng, habits=ufo_habits(), lean=0.0)
    trunk = _limb(wood, 0, Label.TRUNK, UP, rng.uniform(0.5, 0.8), (0.040, 0.034))
    for side in (-1.0, 1.0):
        way = np.array([side, 0.0, 0.0])
        support = _limb(wood, int(trunk[-1]), Label.SUPPORT, way, SUPPORT_M, (0.030, 0.018))
        for number in range(LEADERS):
            at = 0.15 + 0.3 * number + rng.uniform(-0.04, 0.04)
            length = rng.uniform(1.7, 2.2)
            foot = int(support[round(at / STEP)])
            _dress(wood, _limb(wood, foot, Label.LEADER, UP, length, (0.014, 0.006)))
    return wood.skeleton()


def _dress(wood: Wood, leader: Ints) -> None:
    """Side branches along a leader, evenly but for a little, to the front or to the back."""
    rng = wood.rng
    for share in (np.arange(SIDES) + rng.uniform(0.3, 0.7, SIDES)) / SIDES:
        row = int(leader[int(share * 0.9 * len(leader))])
        azimuth = rng.choice([-1, 1]) * math.pi / 2 + rng.uniform(-math.pi / 4, math.pi / 4)
        angle = math.radians(rng.uniform(50, 80))
        out = np.array([math.cos(azimuth), math.sin(azimuth), 0.0])
        way = math.cos(angle) * UP + math.sin(angle) * out
        _limb(wood, row, Label.SIDE_BRANCH, way, rng.uniform(0.12, 0.35), (0.005, 0.0025))


def _limb(wood: Wood, row: int, label: Label, way: Floats, length: float, radii: Range) -> Ints:
    return wood.grow(row, label, np.tile(way, (math.ceil(length / STEP), 1)), length, radii)


def all_round(seed: int) -> Scan:
    """Points all round the tree, 1 mm of noise, nothing else."""
    rng = np.random.default_rng([seed, 2])
    tree = straight_ufo(rng)
    row = Row([tree], wood_of(tree, Kind.TARGET, 0))
    surface = sample_pieces(rng, row.pieces, SPACING_M)
    return _scan(rng, surface.take(~_inside(surface, row.pieces)), row, ROUND_NOISE_M, 0)


def one_side(seed: int) -> Scan:
    """The same tree from in front: 4 mm of noise, 25 holes, two wires, strays."""
    rng = np.random.default_rng([seed, 2])
    tree = straight_ufo(rng)
    row = Row([tree], Pieces.joined([wood_of(tree, Kind.TARGET, 0), *map(_wire, WIRE_HEIGHTS_M)]))
    surface = sample_pieces(rng, row.pieces, SPACING_M)
    surface = surface.take(~_inside(surface, row.pieces))
    surface = surface.take(seen_from(surface, CAMERA, PIXEL_RAD)[0])
    for center in surface.xyz[rng.choice(len(surface.xyz), HOLES)]:
        away = np.linalg.norm(surface.xyz - center, axis=1)
        surface = surface.take(away > rng.uniform(*HOLE_M))
    return _scan(rng, surface, row, SIDE_NOISE_M, round(STRAYS * POINTS))


def _wire(height: float) -> Pieces:
    """A level wire tied to the backs of the leaders."""
    x = np.linspace(-1.6, 1.6, 65)
    line = np.column_stack([x, np.full_like(x, 0.012), np.full_like(x, height)])
    return Pieces.things(line[:-1], line[1:], WIRE_RADIUS_M, Kind.WIRE)


def _inside(surface: Surface, pieces: Pieces) -> Bools:
    """Which samples lie inside thicker wood: the feet of branches, which nobody sees."""
    middle = (pieces.start + pieces.end) / 2
    away, near = cKDTree(middle).query(surface.xyz, k=8)
    along = (pieces.end - pieces.start)[near]
    along /= np.linalg.norm(along, axis=2, keepdims=True)
    offset = surface.xyz[:, None] - middle[near]
    lengthwise = (offset * along).sum(axis=2)
    aside = np.sqrt(np.maximum(away**2 - lengthwise**2, 0))
    deep = (aside < 0.95 * pieces.radius[near]) & (np.abs(lengthwise) <= STEP / 2)
    return np.asarray((deep & (near != surface.piece[:, None])).any(axis=1))


def _scan(rng: Rng, surface: Surface, row: Row, noise: float, strays: int) -> Scan:
    """At most `POINTS` of the samples with noise, and strays, with the truth of each."""
    kept = surface.take(rng.permutation(len(surface.xyz))[: POINTS - strays])
    low, high = kept.xyz.min(axis=0), kept.xyz.max(axis=0)
    xyz = np.concatenate(
        [kept.xyz + rng.normal(0, noise, kept.xyz.shape), rng.uniform(low, high, (strays, 3))]
    )
    none = np.full(strays, NONE)
    kind, tree, node = (
        np.concatenate([column[kept.piece], filler])
        for column, filler in (
            (row.pieces.kind, np.full(strays, Kind.STRAY)),
            (row.pieces.tree, none),
            (row.pieces.row, none),
        )
    )
    return Scan(xyz=xyz, kind=kind, tree=tree, node=node, row=row, views=(), focal=0.0)
