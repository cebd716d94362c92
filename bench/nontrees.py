"""Drawn clouds of what is no fruit tree, Z up, metres: what may lie in a folder by mistake."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from bench.shapes import Piece, dressed, limb, scanned, towards
from prunus.model import Floats

Rng = np.random.Generator
POINTS = 30_000


def noisy(rng: Rng, xyz: Floats) -> Floats:
    """Points (P, 3) as a scanner sees them, up to 8 mm off."""
    return np.asarray(xyz + rng.normal(0, rng.uniform(0.001, 0.008), xyz.shape))


def wall(rng: Rng) -> Floats:
    """An upright surface."""
    x, z = rng.uniform(0, rng.uniform(1, 5), POINTS), rng.uniform(0, rng.uniform(1, 3), POINTS)
    return noisy(rng, np.column_stack([x, np.zeros(POINTS), z]))


def ground(rng: Rng) -> Floats:
    """Uneven ground alone."""
    x, y = rng.uniform(-2.5, 2.5, (2, POINTS))
    wave, height = rng.uniform(0.3, 2.0), rng.uniform(0, 0.15)
    return noisy(rng, np.column_stack([x, y, height * np.sin(x / wave) * np.cos(y / wave)]))


def ball(rng: Rng) -> Floats:
    """The surface of a ball."""
    ways = rng.normal(size=(POINTS, 3))
    radius = rng.uniform(0.2, 1.2)
    return noisy(rng, radius * ways / np.linalg.norm(ways, axis=1)[:, None])


def box(rng: Rng) -> Floats:
    """The surface of a box."""
    xyz = rng.uniform(0, 1, (POINTS, 3))
    xyz[np.arange(POINTS), rng.integers(3, size=POINTS)] = rng.integers(2, size=POINTS)
    return noisy(rng, xyz * rng.uniform(0.5, 2.0, 3))


def noise(rng: Rng) -> Floats:
    """Points anywhere in a box."""
    return np.asarray(rng.uniform(0, 1, (POINTS, 3)) * rng.uniform(0.3, 2.0, 3))


def leaves(rng: Rng) -> Floats:
    """A crown of leaves: discs that lie any way up."""
    count, each = int(rng.integers(400, 1500)), 25
    middle = rng.normal(size=(count, 1, 3)) * rng.uniform(0.3, 0.7, 3)
    first, second = _across(rng, count)
    angle, out = rng.uniform(0, 2 * math.pi, (count, each, 1)), rng.uniform(0, 1, (count, each, 1))
    away = rng.uniform(0.02, 0.05) * np.sqrt(out) * (np.cos(angle) * first + np.sin(angle) * second)
    return noisy(rng, (middle + away).reshape(-1, 3))


def hedge(rng: Rng) -> Floats:
    """Leaves on a box."""
    xyz = box(rng)
    return np.asarray(xyz + rng.normal(0, rng.uniform(0.03, 0.08), xyz.shape))


def heap(rng: Rng) -> Floats:
    """Cut twigs that lie any way up."""
    pieces: list[Piece] = []
    length = rng.uniform(0.08, 0.4)
    for _ in range(int(rng.integers(150, 500))):
        start, way = rng.normal(size=3) * [0.6, 0.4, 0.3], rng.normal(size=3)
        pieces.append((start, start + way / np.linalg.norm(way) * length, 0.004))
    return scanned(rng, pieces, front=bool(rng.integers(2)))


def spruce(rng: Rng) -> Floats:
    """A cone in full needles, its trunk out of sight."""
    height, wide = rng.uniform(1.5, 3.5), rng.uniform(0.5, 1.2)
    z = height * (1 - np.sqrt(rng.uniform(0, 1, POINTS)))
    radius = wide * (1 - z / height) * rng.uniform(0.6, 1.0, POINTS)
    angle = rng.uniform(0, 2 * math.pi, POINTS)
    return noisy(rng, np.column_stack([radius * np.cos(angle), radius * np.sin(angle), z]))


def grass(rng: Rng) -> Floats:
    """Tall blades on ground."""
    pieces: list[Piece] = []
    for _ in range(600):
        start = np.array([*rng.uniform(-0.8, 0.8, 2), 0.0])
        way = towards(rng.uniform(0, 40), rng.uniform(0, 2 * math.pi))
        pieces.append((start, start + way * rng.uniform(0.1, 0.4), 0.002))
    return np.concatenate([scanned(rng, pieces, front=False), 0.4 * ground(rng)[::3]])


def pole(rng: Rng) -> Floats:
    """A bare post, pipe or lamp."""
    lean = towards(rng.uniform(0, 8), rng.uniform(0, 2 * math.pi))
    pieces: list[Piece] = [(np.zeros(3), lean * rng.uniform(1.5, 4), rng.uniform(0.03, 0.10))]
    return scanned(rng, pieces, front=bool(rng.integers(2)))


def trellis(rng: Rng) -> Floats:
    """Posts and wires with nothing on them."""
    height, wide = rng.uniform(1.5, 3), rng.uniform(2, 5)
    pieces: list[Piece] = []
    for x in (0.0, wide):
        pieces.append((np.array([x, 0, 0]), np.array([x, 0, height]), rng.uniform(0.03, 0.06)))
    for z in np.linspace(0.4, height, int(rng.integers(2, 6))):
        pieces.append((np.array([0, 0, z]), np.array([wide, 0, z]), 0.002))
    return scanned(rng, pieces, front=bool(rng.integers(2)))


def brush(rng: Rng) -> Floats:
    """Suckers: many thin shoots out of the ground, and no trunk."""
    pieces: list[Piece] = []
    for _ in range(int(rng.integers(40, 120))):
        start = np.array([*rng.normal(0, 0.3, 2), 0.0])
        way = towards(rng.uniform(0, 35), rng.uniform(0, 2 * math.pi))
        pieces += limb(rng, start, way, rng.uniform(0.5, 1.5), 0.005)
    return scanned(rng, pieces, front=bool(rng.integers(2)))


def fir(rng: Rng) -> Floats:
    """A conifer of which trunk and limbs are in view: whorls that droop, in needles."""
    trunk = limb(
        rng, np.zeros(3), towards(0, 0), rng.uniform(2, 3.5), rng.uniform(0.03, 0.06), 0.02
    )
    twigs: list[Piece] = []
    for start, _, _ in trunk[2:]:
        share = start[2] / trunk[-1][1][2]
        for azimuth in rng.uniform(0, 2 * math.pi, int(rng.integers(4, 8))):
            way = towards(rng.uniform(85, 115), azimuth)
            twigs += limb(rng, start, way, 1.0 * (1.1 - share), 0.008)
    needles: list[Piece] = []
    for start, end, _ in twigs:
        for along in rng.uniform(0, 1, (25, 1)):
            way = rng.normal(size=3)
            foot = (1 - along) * start + along * end
            needles.append((foot, foot + 0.025 * way / np.linalg.norm(way), 0.001))
    return scanned(rng, trunk + twigs + needles, front=bool(rng.integers(2)))


def bush(rng: Rng) -> Floats:
    """A shrub: many crooked stems out of one place, each with branches all round."""
    pieces: list[Piece] = []
    for _ in range(int(rng.integers(8, 20))):
        start = np.array([*rng.normal(0, 0.08, 2), 0.0])
        way = towards(rng.uniform(5, 55), rng.uniform(0, 2 * math.pi))
        stem = limb(rng, start, way, rng.uniform(0.8, 1.8), rng.uniform(0.006, 0.014), 0.15)
        pieces += stem + dressed(rng, stem, int(rng.integers(6, 15)), 0.5, (20, 80))
    return scanned(rng, pieces, front=bool(rng.integers(2)))


def fence(rng: Rng) -> Floats:
    """Wire mesh between posts, or rails."""
    wide, height, mesh = rng.uniform(2, 4), rng.uniform(1, 1.8), rng.uniform(0.08, 0.4)
    thick = rng.uniform(0.002, 0.02)
    pieces: list[Piece] = []
    for x in np.arange(0, wide, mesh):
        pieces.append((np.array([x, 0, 0]), np.array([x, 0, height]), thick))
    for z in np.arange(mesh, height, mesh):
        pieces.append((np.array([0, 0, z]), np.array([wide, 0, z]), thick))
    return scanned(rng, pieces, front=bool(rng.integers(2)))


def litter(rng: Rng) -> Floats:
    """What was pruned off, whole branches of it, on a heap on the ground."""
    pieces: list[Piece] = []
    for _ in range(int(rng.integers(15, 50))):
        start = np.array([*rng.normal(0, 0.6, 2), rng.uniform(0, 0.4)])
        way = towards(rng.uniform(70, 110), rng.uniform(0, 2 * math.pi))
        one = limb(rng, start, way, rng.uniform(0.6, 1.8), rng.uniform(0.006, 0.02))
        pieces += one + dressed(rng, one, int(rng.integers(2, 8)), 0.3, (20, 80))
    return scanned(rng, pieces, front=bool(rng.integers(2)))


NO_TREES: dict[str, Callable[[Rng], Floats]] = {
    "wall": wall, "ground": ground, "ball": ball, "box": box, "noise": noise, "leaves": leaves,
    "hedge": hedge, "heap": heap, "spruce": spruce, "grass": grass, "pole": pole,
    "trellis": trellis, "brush": brush, "fir": fir, "bush": bush, "fence": fence, "litter": litter,
}  # fmt: skip


def _across(rng: Rng, count: int) -> tuple[Floats, Floats]:
    """Two directions (N, 1, 3) across each other, any way up."""
    first = rng.normal(size=(count, 1, 3))
    first /= np.linalg.norm(first, axis=2, keepdims=True)
    second = np.cross(first, rng.normal(size=(count, 1, 3)))
    return first, np.asarray(second / np.linalg.norm(second, axis=2, keepdims=True))
