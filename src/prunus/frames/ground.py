"""The ground under a scan, whichever axis points up: broad both ways, thin, with the rest above it.

Floors are found however many of the points they hold. What is no ground is told by where wood is
and runs: the leaders of a row lie in a plane, too, and so do walls, but wood stands on ground.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from prunus.frames.patches import Cells, Patches
from prunus.model import Bools, Floats, Ints

PATCH_M, PATCH_CELLS = 0.20, 5
"""Radius of the patches that are looked at, and in sides of the cells at least."""
BROAD, THIN, FEWEST_CELLS = 0.35, 0.15, 12
"""A patch is flat when it is so broad for its length, so thin for its breadth (variances), and
holds so many cells."""
BAND_M = 0.05
"""Ground rises and falls by so much."""
PARALLEL = math.cos(math.radians(20))
"""Flat patches of one plane have normals so near to each other (cosine)."""
PLANES, GUESSES, FEWEST_PATCHES = 6, 300, 8
"""So many planes are looked for, each guessed from so many flat patches; fewer make none."""
SQUARE_M, FILLED = 0.10, 7
"""A plane is looked at in squares of that side; one is inside the ground when so many of the nine
about it are held."""
LEAST_AREA_M2, LEAST_WIDTH_M, LEAST_FILL = 0.40, 0.28, 0.60
"""Ground is so large, so broad across, and fills such a share of what is held in its plane."""
MOST_BELOW = 0.02
"""So small a share of all else lies under the ground."""
LINE, FEWEST_WOOD = 0.5, 20
"""A patch that is a line by so much is wood; fewer pieces tell nothing."""
FLOOR, STANDING_ON_FLOOR, STANDING = 0.50, 0.25, 0.40
"""On a floor, of whose patches such a share is flat, so much of the wood stands upright; on other
ground so much, and"""
STANDING_OF_ALL, TALL_M, SOLID, STEEPEST_DEG = 0.25, 0.70, 0.40, 25.0
"""so much with the lines in its plane; a tenth of the rest is so high over it; such a share of its
area is held; and it is so near to level on some axis."""
LAWN_BAND_M, LAWN_WIDTH_M, LAWN_FILL, ONE_WAY = 0.15, 1.5, 0.30, 0.70
"""A lawn is rougher (grass, clods), so broad, filled less, and of its lines at most such a share
runs one way, as the leaders of a row do."""
WAYS, SLAB_M, SLAB_CELLS = 200, 0.10, 8000
"""Lawns are looked for in the fullest slab of so many directions, among so many cells."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Ground:
    """A plane through `middle` (3,), normal `up` (3,), and which cells (N,) are of it.

    `length` and `width` say how far it reaches, along `along` (3,) and across it, metres.
    """

    up: Floats
    middle: Floats
    cells: Bools
    along: Floats
    length: float
    width: float

    def turned(self, rotation: Floats) -> Ground:
        """The same ground in another frame."""
        up, middle, along = rotation @ self.up, rotation @ self.middle, rotation @ self.along
        return replace(self, up=up, middle=middle, along=along)


def find_ground(cells: Cells) -> Ground | None:
    """The ground under a scan, in any orientation; None where none is evident."""
    patches = Patches.of(cells, max(PATCH_M, PATCH_CELLS * cells.side))
    found = [_as_ground(plane, cells, patches) for plane in _planes(patches, cells.side)]
    grounds = [ground for ground in found if ground is not None]
    if grounds:
        return max(grounds, key=lambda ground: ground.length * ground.width)
    return _as_ground(_fullest_slab(cells), cells, patches)


def is_flat(patches: Patches) -> Bools:
    """Which patches (C,) are of a surface."""
    thick, broad, long = patches.variance.T
    flat = (broad > BROAD * long) & (thick < THIN * broad)
    return np.asarray(flat & (patches.count >= FEWEST_CELLS))


@dataclass(frozen=True, eq=False)
class _Plane:
    """A plane that may be ground: normal and middle (3,), and how far it rises and falls."""

    normal: Floats
    middle: Floats
    band: float
    lawn: bool = False

    @classmethod
    def through(cls, xyz: Floats, band: float, lawn: bool = False) -> _Plane:
        """The plane nearest to points (Q, 3)."""
        middle = xyz.mean(axis=0)
        return cls(np.linalg.eigh(np.cov((xyz - middle).T, bias=True))[1][:, 0], middle, band, lawn)

    @property
    def axes(self) -> Floats:
        """Two directions in the plane, as columns (3, 2)."""
        return np.asarray(np.linalg.svd(self.normal[None])[2][1:].T)

    def height(self, xyz: Floats) -> Floats:
        """How far points (Q, 3) are over it."""
        return np.asarray((xyz - self.middle) @ self.normal)

    def holds(self, xyz: Floats) -> Bools:
        """Which points (Q, 3) are of it."""
        return np.abs(self.height(xyz)) < self.band

    def facing(self, xyz: Floats) -> _Plane:
        """The same plane with most of all other points over it."""
        height = self.height(xyz)
        over, under = (height > self.band).sum(), (height < -self.band).sum()
        return self if over >= under else replace(self, normal=-self.normal)


def _planes(patches: Patches, side: float) -> Iterator[_Plane]:
    """Planes that hold many flat patches, the fullest first (RANSAC, one after another)."""
    flat = patches.take(is_flat(patches))
    band = max(BAND_M, side)
    left = np.ones(len(flat.xyz), np.bool_)
    for _ in range(PLANES):
        rows = np.flatnonzero(left)
        if len(rows) < FEWEST_PATCHES:
            return
        plane = _Plane(*_guess(flat, left, rows[:: -(-len(rows) // GUESSES)], band), band)
        for _ in range(3):
            parallel = np.abs(flat.normals @ plane.normal) > PARALLEL
            held = left & parallel & plane.holds(flat.xyz)
            if held.sum() >= FEWEST_PATCHES:
                plane = _Plane.through(flat.xyz[held], band)
        left = left & ~held & (np.abs(plane.height(flat.xyz)) >= 2 * band)
        yield plane


def _guess(flat: Patches, left: Bools, rows: Ints, band: float) -> tuple[Floats, Floats]:
    """Of the planes of some patches, normal and middle of that which most others lie in."""
    away = flat.xyz @ flat.normals[rows].T - (flat.xyz[rows] * flat.normals[rows]).sum(axis=1)
    on = (np.abs(away) < band) & (np.abs(flat.normals @ flat.normals[rows].T) > PARALLEL)
    best = rows[int((on & left[:, None]).sum(axis=0).argmax())]
    return flat.normals[best], flat.xyz[best]


def _fullest_slab(cells: Cells) -> _Plane:
    """The plane about which most of a scan lies, however rough it is."""
    xyz = cells.xyz[:: -(-len(cells.xyz) // SLAB_CELLS)]
    turn = np.arange(WAYS) * math.pi * (3 - math.sqrt(5))
    up = (np.arange(WAYS) + 0.5) / WAYS
    out = np.sqrt(1 - up**2)
    slab = np.rint(xyz @ np.stack([out * np.cos(turn), out * np.sin(turn), up]) / SLAB_M)
    held = [_fullest(column.astype(np.int64)) for column in slab.T]
    plane = _Plane.through(xyz[max(held, key=lambda rows: rows.sum())], LAWN_BAND_M, lawn=True)
    for _ in range(5):
        plane = _Plane.through(xyz[plane.holds(xyz)], LAWN_BAND_M, lawn=True)
    return plane


def _fullest(number: Ints) -> Bools:
    """Which rows (Q,) have the most frequent number."""
    number = number - number.min()
    return np.asarray(number == np.bincount(number).argmax())


def _as_ground(plane: _Plane, cells: Cells, patches: Patches) -> Ground | None:
    """The ground in a plane, if it is evidently that."""
    plane = plane.facing(cells.xyz)
    height = plane.height(cells.xyz)
    above, below = (height > plane.band).sum(), (height < -2 * plane.band).sum()
    if below > MOST_BELOW * (above + below) or not _is_stood_on(plane, patches):
        return None
    near = np.flatnonzero(plane.holds(cells.xyz))
    inside, fill = _filled((cells.xyz[near] - plane.middle) @ plane.axes, cells.side)
    held = near[inside]
    if fill < (LAWN_FILL if plane.lawn else LEAST_FILL) or len(held) < FEWEST_CELLS:
        return None
    if not _is_floor(plane, patches) and not _is_rough(plane, height, cells, held):
        return None
    return _measured(plane, cells.xyz, held)


def _is_stood_on(plane: _Plane, patches: Patches) -> bool:
    """Whether wood stands on a plane, rather than runs in it."""
    on, lines = plane.holds(patches.xyz), ~is_flat(patches) & (patches.linear > LINE)
    if (lines & ~on).sum() < FEWEST_WOOD:
        return False
    standing = _standing(patches.take(lines & ~on), plane)
    if plane.lawn:
        return standing >= STANDING and _one_way(patches.take(lines & on), plane) <= ONE_WAY
    if _is_floor(plane, patches):
        return standing >= STANDING_ON_FLOOR
    return standing >= STANDING and _standing(patches.take(lines), plane) >= STANDING_OF_ALL


def _is_floor(plane: _Plane, patches: Patches) -> bool:
    on = plane.holds(patches.xyz)
    return not plane.lawn and bool(is_flat(patches)[on].sum() >= FLOOR * max(on.sum(), 1))


def _is_rough(plane: _Plane, height: Floats, cells: Cells, held: Ints) -> bool:
    """Whether what is no floor is ground, from the height (N,) and the cells that it holds."""
    rest = height[np.abs(height) >= plane.band]
    tall = len(rest) > 0 and np.quantile(rest, 0.9) >= TALL_M
    steep = np.abs(plane.normal).max() < math.cos(math.radians(STEEPEST_DEG))
    places = (cells.xyz[held] - plane.middle) @ plane.axes
    squares, fine = (len(np.unique(np.rint(places / s), axis=0)) for s in (SQUARE_M, cells.side))
    solid = fine * min(1.0, (cells.side / SQUARE_M) ** 2) >= SOLID * squares
    return bool(tall and not steep and (solid or plane.lawn))


def _standing(wood: Patches, plane: _Plane) -> float:
    """How much of wood runs along the normal, 0 to 1."""
    return float(wood.linear @ (wood.directions @ plane.normal) ** 2 / wood.linear.sum())


def _one_way(wood: Patches, plane: _Plane) -> float:
    """How much of what lies in a plane runs along one line of it, half to 1; half of nothing."""
    across = wood.directions @ plane.axes
    least, most = np.linalg.eigvalsh((wood.linear[:, None] * across).T @ across)
    return float((most + 1e-9) / (least + most + 2e-9))


def _filled(places: Floats, side: float) -> tuple[Bools, float]:
    """Which places (Q, 2) of a plane lie where it is filled, and what share of its squares is."""
    square = np.rint(places / max(SQUARE_M, 2 * side)).astype(np.int64)
    square -= square.min(axis=0) - 1
    held = np.zeros(square.max(axis=0) + 2, np.bool_)
    held[square[:, 0], square[:, 1]] = True
    inner = held & (_around(held) >= FILLED)
    filled = held & (_around(inner) > 0)
    return filled[square[:, 0], square[:, 1]], float(filled.sum() / held.sum())


def _around(squares: Bools) -> Ints:
    """How many of the nine squares about each are held; the outermost hold nothing."""
    steps = [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1)]
    return np.asarray(np.sum([np.roll(squares, step, (0, 1)) for step in steps], axis=0))


def _measured(plane: _Plane, xyz: Floats, held: Ints) -> Ground | None:
    """The ground that some of the cells (N, 3) hold, if it is large enough."""
    places = (xyz[held] - plane.middle) @ plane.axes
    variance, ways = np.linalg.eigh(np.cov(places.T, bias=True))
    width, length = np.sqrt(12 * np.maximum(variance, 0))
    if width < (LAWN_WIDTH_M if plane.lawn else LEAST_WIDTH_M) or width * length < LEAST_AREA_M2:
        return None
    along = plane.axes @ ways[:, 1]
    lowest = _lowest(plane, xyz[held])
    near = np.abs(lowest.height(xyz)) < 2 * plane.band
    return Ground(
        up=lowest.normal,
        middle=lowest.middle,
        cells=near,
        along=along,
        length=float(length),
        width=float(width),
    )


def _lowest(plane: _Plane, xyz: Floats) -> _Plane:
    """The plane through the lowest of what lies over each of its squares: grass stands on it."""
    for _ in range(2):
        square = np.rint((xyz - plane.middle) @ plane.axes / SQUARE_M).astype(np.int64)
        order = np.lexsort([plane.height(xyz), square[:, 1], square[:, 0]])
        first = np.ones(len(order), np.bool_)
        first[1:] = (np.diff(square[order], axis=0) != 0).any(axis=1)
        low = xyz[order[first]]
        found = _Plane.through(low, BAND_M)
        near = found.holds(low)
        found = _Plane.through(low[near], BAND_M) if near.sum() >= FEWEST_CELLS else found
        plane = found if found.normal @ plane.normal > 0 else replace(found, normal=-found.normal)
    return plane
