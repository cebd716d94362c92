"""Points of a scan chosen by box, lasso, brush, component or class, and what they are marked as."""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import NDArray

from prunus.corrections.where import Box, Brush, Class, Component, Lasso, Shape
from prunus.kernels.forest import components
from prunus.kernels.neighbours import nearest
from prunus.model import Bools, Floats, Ints, PointCloud
from prunus.model.arrays import cubes

Kinds = NDArray[np.int8]
"""A `model.Kind` for each point (P,)."""
CLICK = 0.50
"""A component is picked by a place so near to one of its points, metres."""


def chosen(where: Shape, scan: PointCloud, kind: Kinds) -> Bools:
    """Which points (P,) of a scan, of these kinds now, a shape holds."""
    if isinstance(where, Class):
        return np.asarray(kind == where.kind)
    if isinstance(where, Brush):
        centres = scan.to_input.inverse().apply(where.centres)
        return np.asarray(nearest(scan.xyz, centres, where.radius) >= 0)
    if isinstance(where, Component):
        return _component(where, scan, kind)
    xyz = scan.to_input.apply(scan.xyz)
    if isinstance(where, Box):
        return np.asarray(((xyz >= where.low) & (xyz <= where.high)).all(axis=1))
    return _lassoed(where, xyz)


def _component(where: Component, scan: PointCloud, kind: Kinds) -> Bools:
    """The points that touching cubes of the side `gap` join to the one picked."""
    away = np.linalg.norm(scan.xyz - scan.to_input.inverse().apply(where.place), axis=1)
    picked = int(away.argmin())
    found = np.zeros(len(scan), np.bool_)
    if away[picked] > CLICK:
        return found
    alike = np.flatnonzero(kind == kind[picked])
    side = max(where.gap, float(np.ptp(scan.xyz, axis=0).max()) / 2**20)
    occupied, cube = np.unique(cubes(scan.xyz[alike], side), return_inverse=True)
    piece = components(len(occupied), _touching(occupied))[cube.ravel()]
    found[alike[piece == piece[np.searchsorted(alike, picked)]]] = True
    return found


def _touching(occupied: Ints) -> Ints:
    """The pairs (E, 2) of occupied cubes, sorted by number, that touch, be it at a corner."""
    pairs = []
    for dx, dy, dz in product((-1, 0, 1), repeat=3):
        step = (dx << 42) + (dy << 21) + dz
        if step > 0:
            at = np.searchsorted(occupied, occupied + step)
            there = np.minimum(at, len(occupied) - 1)
            hits = np.flatnonzero(occupied[there] == occupied + step)
            pairs.append(np.column_stack([hits, there[hits]]))
    return np.concatenate(pairs)


def _lassoed(where: Lasso, xyz: Floats) -> Bools:
    projection = np.array(where.projection)
    seen = xyz @ projection[:, :3].T + projection[:, 3]
    shown = seen[:, 3] > 0
    if where.slab is not None:
        depth = xyz @ np.array(where.slab.direction)
        shown &= (depth >= where.slab.low) & (depth <= where.slab.high)
    image = seen[:, :2] / np.where(shown, seen[:, 3], 1.0)[:, None]
    polygon = np.array(where.polygon)
    shown &= ((image >= polygon.min(axis=0)) & (image <= polygon.max(axis=0))).all(axis=1)
    rows = np.flatnonzero(shown)
    shown[rows] = inside(image[rows], polygon)
    return np.asarray(shown)


def inside(points: Floats, polygon: Floats) -> Bools:
    """Which points (P, 2) a polygon (Q, 2) surrounds: an odd number of its sides is to the left."""
    odd = np.zeros(len(points), np.bool_)
    x, y = points.T
    for (x0, y0), (x1, y1) in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        if y0 != y1:
            crosses = (y0 > y) != (y1 > y)
            odd ^= crosses & (x < x0 + (y - y0) / (y1 - y0) * (x1 - x0))
    return odd
