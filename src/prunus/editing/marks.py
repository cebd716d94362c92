"""Points of a scan chosen by box, lasso, brush, component or class, and what they are marked as."""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import NDArray

from prunus.editing.where import Box, Brush, Class, Component, Lasso, Shape
from prunus.geometry.near import nearest
from prunus.geometry.pieces import components
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
    if isinstance(where, Box):
        xyz = scan.to_input.apply(scan.xyz)
        return _between(xyz, np.array(where.low), np.array(where.high))
    if isinstance(where, Lasso):
        return _lassoed(where, scan)
    if isinstance(where, Brush):
        return _brushed(where, scan)
    return _component(where, scan, kind)


def _between(points: Floats, low: Floats, high: Floats) -> Bools:
    """Which points (P, D) lie between two corners; a column at a time is quicker."""
    held = np.ones(len(points), np.bool_)
    for column, least, most in zip(points.T, low, high, strict=True):
        held &= (column >= least) & (column <= most)
    return held


def _brushed(where: Brush, scan: PointCloud) -> Bools:
    centres = scan.to_input.inverse().apply(where.centres)
    reach = where.radius
    found = _between(scan.xyz, centres.min(axis=0) - reach, centres.max(axis=0) + reach)
    rows = np.flatnonzero(found)
    found[rows] = nearest(scan.xyz[rows], centres, reach) >= 0
    return found


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


def _lassoed(where: Lasso, scan: PointCloud) -> Bools:
    xyz = scan.to_input.apply(scan.xyz)
    projection = np.array(where.projection)
    far = xyz @ projection[3, :3] + projection[3, 3]
    shown = far > 0
    if where.slab is not None:
        depth = xyz @ np.array(where.slab.direction)
        shown &= (depth >= where.slab.low) & (depth <= where.slab.high)
    rows = np.flatnonzero(shown)
    image = (xyz[rows] @ projection[:2, :3].T + projection[:2, 3]) / far[rows, None]
    polygon = np.array(where.polygon)
    near = _between(image, polygon.min(axis=0), polygon.max(axis=0))
    near[near] = inside(image[near], polygon)
    shown[rows] = near
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
