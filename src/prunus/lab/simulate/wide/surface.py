"""Surfaces of round pieces as points, and which of them a station sees (a z-buffer of angles)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from prunus.geometry.vectors import unit
from prunus.lab.simulate.row import NONE, Pieces
from prunus.model import Bools, Floats, Ints

MOST_SAMPLES = 1_500_000
THINNEST_M = 0.003  # thinner wood is sampled as densely as wood of this radius


@dataclass(frozen=True, eq=False, kw_only=True)
class Surface:
    """Points xyz (P, 3) with their outward normals (P, 3), zero = unknown, and pieces (P,)."""

    xyz: Floats
    normal: Floats
    piece: Ints

    def take(self, rows: Ints | Bools) -> Surface:
        """The surface of these rows only."""
        return Surface(xyz=self.xyz[rows], normal=self.normal[rows], piece=self.piece[rows])

    def joined(self, other: Surface) -> Surface:
        """Both surfaces."""
        return Surface(
            xyz=np.concatenate([self.xyz, other.xyz]),
            normal=np.concatenate([self.normal, other.normal]),
            piece=np.concatenate([self.piece, other.piece]),
        )


def loose(xyz: Floats, piece: int = NONE) -> Surface:
    """Points that face every way and belong to no piece."""
    return Surface(xyz=xyz, normal=np.zeros_like(xyz), piece=np.full(len(xyz), piece))


def sample_pieces(rng: np.random.Generator, pieces: Pieces, spacing: float) -> Surface:
    """Points drawn evenly over the mantles of all pieces, about one in `spacing` squared."""
    vector = pieces.end - pieces.start
    length = np.linalg.norm(vector, axis=1)
    area = 2 * math.pi * np.maximum(pieces.radius, THINNEST_M) * length
    count = int(min(MOST_SAMPLES, area.sum() / spacing**2))
    piece = np.sort(rng.choice(len(area), count, p=area / area.sum()))
    axis = vector[piece] / np.maximum(length[piece], 1e-9)[:, None]
    least = np.eye(3)[np.abs(axis).argmin(axis=1)]
    first = unit(np.cross(axis, least))
    second = np.cross(axis, first)
    turn = rng.uniform(0, 2 * math.pi, (count, 1))
    normal = np.cos(turn) * first + np.sin(turn) * second
    along = pieces.start[piece] + rng.random((count, 1)) * vector[piece]
    return Surface(xyz=along + pieces.radius[piece, None] * normal, normal=normal, piece=piece)


def seen_from(surface: Surface, station: Floats, resolution: float) -> tuple[Ints, Ints]:
    """The nearest point in each pixel, and for each the one behind it that is seen past its edge.

    Pixels are squares of `resolution` radians in azimuth and elevation. Rows (V,) of the surface,
    and of the same length the row of the farthest point in that pixel.
    """
    ray = surface.xyz - station
    distance = np.linalg.norm(ray, axis=1)
    facing = (surface.normal * ray).sum(axis=1) <= 0
    rows = np.flatnonzero(facing & (distance > 0.1))
    ray = ray[rows]
    pixel = np.column_stack(
        [
            np.floor(np.arctan2(ray[:, 1], ray[:, 0]) / resolution),
            np.floor(np.arctan2(ray[:, 2], np.hypot(ray[:, 0], ray[:, 1])) / resolution),
        ]
    ).astype(np.int64)
    key = pixel[:, 0] * 1_000_003 + pixel[:, 1]
    order = np.lexsort((distance[rows], key))
    new = np.flatnonzero(np.diff(key[order], prepend=key[order[0]] - 1)) if len(order) else order
    last = np.append(new[1:], len(order)) - 1
    return rows[order[new]], rows[order[last]]
