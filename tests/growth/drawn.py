"""Threads of drawn trees: nodes every 12 mm along polylines, all that is said of them right."""

import itertools

import numpy as np

from prunus.field.votes import Threads
from prunus.growth.graph import join_threads
from prunus.growth.grow import Orchard
from prunus.model import Floats, Role, Skeleton

APART_M = 0.012
Piece = tuple[Role, list[tuple[float, float, float]], float]
"""Role, corners from the foot outward, radius."""

TEXTBOOK: list[Piece] = [
    (Role.STEM, [(0, 0, 0), (0, 0, 0.6)], 0.03),
    (Role.FRAMEWORK, [(0, 0, 0.61), (0.9, 0, 0.65)], 0.02),
    (Role.FRAMEWORK, [(0, 0, 0.61), (-0.9, 0, 0.65)], 0.02),
    *[(Role.FRUITING_UNIT, [(x, 0, 0.67), (x, 0, 1.9)], 0.012) for x in (-0.8, -0.4, 0.4, 0.8)],
    (Role.LATERAL, [(0.415, 0, 1.2), (0.6, 0.05, 1.3)], 0.004),
    (Role.LATERAL, [(-0.415, 0, 1.4), (-0.6, -0.1, 1.5)], 0.004),
]
"""Four leaders on two supports, two side branches."""


def threads_of(pieces: list[Piece], seed: int | None = None) -> Threads:
    """The threads of some pieces; with a seed every place is a few millimetres off."""
    xyz, role, radius, toward_foot = [], [], [], []
    for one, corners, thick in pieces:
        nodes, direction = _along(np.array(corners, np.float64))
        xyz.append(nodes)
        toward_foot.append(-direction)
        role += [one] * len(nodes)
        radius += [thick] * len(nodes)
    places = np.concatenate(xyz)
    if seed is not None:
        places = places + np.random.default_rng(seed).normal(0, 0.002, places.shape)
    chance = np.full((len(role), len(Role)), 0.02)
    chance[np.arange(len(role)), role] = 0.90
    return Threads(
        xyz=places,
        role=chance,
        radius=np.array(radius),
        toward_foot=np.concatenate(toward_foot),
        votes=np.full(len(role), 5.0),
        scatter=np.zeros(len(role)),
        beyond=np.zeros((len(role), 2)),
        of_voxel=np.arange(len(role)),
    )


def _along(corners: Floats) -> tuple[Floats, Floats]:
    nodes, directions = [], []
    for start, end in itertools.pairwise(corners):
        length = np.linalg.norm(end - start)
        share = np.arange(0, length, APART_M)[:, None] / length
        nodes.append(start + share * (end - start))
        directions.append(np.repeat([(end - start) / length], len(share), axis=0))
    return np.concatenate(nodes), np.concatenate(directions)


def surface_of(pieces: list[Piece], rng: np.random.Generator, apart: float = 0.004) -> Floats:
    """Points (P, 3) of the surface of some pieces, with a millimetre of noise."""
    found = []
    for _, corners, radius in pieces:
        for start, end in itertools.pairwise(corners):
            axis = np.subtract(end, start)
            length = float(np.linalg.norm(axis))
            count = int(2 * np.pi * radius * length / apart**2)
            aside = np.cross(axis, [0.3, 0.5, 0.8])
            aside /= np.linalg.norm(aside)
            turn = rng.uniform(0, 2 * np.pi, (count, 1))
            ring = np.cos(turn) * aside + np.sin(turn) * np.cross(axis / length, aside)
            found.append(start + rng.random((count, 1)) * axis + radius * ring)
    places = np.concatenate(found)
    return np.asarray(places + rng.normal(0, 0.001, places.shape))


def grow(threads: Threads, base: Floats | None = None) -> Skeleton:
    """The tree of some threads: of that at `base` (3,), or of that at which the scanner looks."""
    orchard = Orchard.of(join_threads(threads), base)
    return orchard.tree_at(orchard.main)
