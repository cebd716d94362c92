"""A cloud as voxels, and the tables by which a sparse network walks over them.

A sparse convolution is a gather and a matrix product: for each voxel the rows of its 27 neighbours,
or the row past the end where one is empty. So the network is plain ONNX and needs no library of
its own.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from prunus.model import Floats, Ints

VOXEL_M = 0.02
LEVELS = 5  # 2, 4, 8, 16 and 32 cm
FEATURES = 13
NEIGHBOURS = np.array([(i, j, k) for i in (-1, 0, 1) for j in (-1, 0, 1) for k in (-1, 0, 1)])
LARGEST = 1 << 20  # voxels along an axis that a key can tell apart


@dataclass(frozen=True, eq=False, kw_only=True)
class Level:
    """Voxels of one size, V of them, as cells (V, 3).

    neighbours (V, 27): their rows, V = empty; parent (V,): the row of the voxel of twice the size
    that holds each; children (W, 8): the rows in each of those, V = none.
    """

    cells: Ints
    neighbours: Ints
    parent: Ints
    children: Ints


@dataclass(frozen=True, eq=False, kw_only=True)
class Voxels:
    """The occupied voxels of a cloud, as `cells` (V, 3).

    xyz (V, 3): the mean of the points of each; count (V,): how many; spread (V, 6): their
    covariance, in voxels; of_point (P,): the voxel of each point; ground, top: the heights between
    which the points lie, metres.
    """

    cells: Ints
    xyz: Floats
    count: Ints
    of_point: Ints
    spread: Floats
    corner: Floats
    size: float
    ground: float
    top: float

    def holding(self, xyz: Floats) -> Ints:
        """The row (P,) of the voxel that holds each of other points (P, 3), -1 = none does."""
        keys = _keys(self.cells)
        wanted = _keys(np.floor((xyz - self.corner) / self.size).astype(np.int64))
        at = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
        return np.where(keys[at] == wanted, at, -1)

    @cached_property
    def levels(self) -> tuple[Level, ...]:
        """The levels of the pyramid, the finest first."""
        found, cells = [], self.cells
        for _ in range(LEVELS):
            level, cells = _level(cells)
            found.append(level)
        return tuple(found)

    def features(self, off: float = 0.0) -> Floats:
        """What the network sees of each voxel (V, `FEATURES`), single precision.

        Where the mean of its points lies in it (3), their covariance (6), how many there are, the
        height over the ground, metres, and as a share of that of the top. In training the ground
        is `off`, metres.
        """
        inside = (self.xyz - self.corner) / self.size - self.cells - 0.5
        height = self.xyz[:, 2] - self.ground - off
        share = height / max(self.top - self.ground - off, self.size)
        columns = [inside, self.spread, np.log1p(self.count) / 3, height, share]
        columns.append(np.ones(len(height)))
        return np.column_stack(columns).astype(np.float32)


def voxels_of(xyz: Floats, size: float = VOXEL_M, shift: Floats | None = None) -> Voxels:
    """The voxels of points (P, 3); `shift` (3,) moves the grid, in shares of a voxel."""
    corner = xyz.min(axis=0) - size * (0.0 if shift is None else shift)
    cell = np.floor((xyz - corner) / size).astype(np.int64)
    keys, first, of_point, count = np.unique(
        _keys(cell), return_index=True, return_inverse=True, return_counts=True
    )
    mean = _sums(xyz, of_point, len(keys)) / count[:, None]
    off = (xyz - mean[of_point]) / size
    products = np.column_stack([off[:, i] * off[:, j] for i in range(3) for j in range(i, 3)])
    spread = _sums(products, of_point, len(keys)) / count[:, None]
    ground, top = heights_of(xyz)
    return Voxels(
        cells=cell[first],
        xyz=mean,
        count=count,
        of_point=of_point,
        spread=spread,
        corner=corner,
        size=size,
        ground=ground,
        top=top,
    )


def heights_of(xyz: Floats) -> tuple[float, float]:
    """How high the lowest and the highest points (P, 3) are, metres; few strays do not count."""
    low, high = np.percentile(xyz[:, 2], [0.5, 99.5])
    return float(low), float(high)


def _sums(values: Floats, owner: Ints, owners: int) -> Floats:
    """The sums (N, C) of the rows (P, C) that each owner has."""
    return np.column_stack([np.bincount(owner, column, owners) for column in values.T])


def _keys(cells: Ints) -> Ints:
    """One number a cell; they sort as the cells do, X first."""
    x, y, z = (cells + 1).T
    return np.asarray((x * LARGEST + y) * LARGEST + z)


def _level(cells: Ints) -> tuple[Level, Ints]:
    """A level of voxels in the order of their keys, and the cells of the next level."""
    keys, count = _keys(cells), len(cells)
    neighbours = np.full((count, len(NEIGHBOURS)), count)
    # A neighbour's key differs by a constant; the table is symmetric, so half of it is looked up.
    for column, step in enumerate(_keys(NEIGHBOURS - 1)[: len(NEIGHBOURS) // 2]):
        at = np.searchsorted(keys, keys + step)
        held = np.flatnonzero(keys[np.minimum(at, count - 1)] == keys + step)
        neighbours[held, column] = at[held]
        neighbours[at[held], len(NEIGHBOURS) - 1 - column] = held
    neighbours[:, len(NEIGHBOURS) // 2] = np.arange(count)
    halved = cells >> 1
    above, first, parent = np.unique(_keys(halved), return_index=True, return_inverse=True)
    children = np.full((len(above), 8), count)
    children[parent, (cells & 1) @ np.array([4, 2, 1])] = np.arange(count)
    level = Level(cells=cells, neighbours=neighbours, parent=parent, children=children)
    return level, halved[first]
