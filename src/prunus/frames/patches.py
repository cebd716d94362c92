"""A scan in cells of even size, and the shape of small patches of it: wood is a line, ground flat.

However dense a floor or a trunk was scanned, each place counts once.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from prunus.geometry.near import within
from prunus.model import Bools, Floats, Ints
from prunus.model.arrays import cubes

SIDE_M = 0.03
"""Side of the cells; larger where a scan fills more than `MOST_CELLS` of them."""
MOST_CELLS = 60_000
MAX_POINTS = 500_000
"""Larger clouds are thinned to so many points before they are looked at."""
STRAY_POINTS = 2
"""Cells with fewer points are strays, where most of the scan is denser."""
MOST_PATCHES = 4000


@dataclass(frozen=True, eq=False)
class Cells:
    """The mean point (N, 3) of each cell of a scan, from its middle (3,) on; the cells' side."""

    xyz: Floats
    side: float
    middle: Floats = field(default_factory=lambda: np.zeros(3))

    @classmethod
    def of(cls, xyz: Floats) -> Cells:
        """The cells of a scan (P, 3)."""
        xyz = xyz[:: -(-len(xyz) // MAX_POINTS)]
        middle = (xyz.min(axis=0) + xyz.max(axis=0)) / 2
        xyz = xyz - middle
        side = SIDE_M
        cell, count = cells_at(xyz, side)
        while len(count) > MOST_CELLS:
            side *= 1.5
            cell, count = cells_at(xyz, side)
        mean = np.column_stack([np.bincount(cell, xyz[:, k]) / count for k in range(3)])
        dense = count >= STRAY_POINTS
        return cls(mean[dense] if 2 * dense.sum() >= len(count) else mean, side, middle)

    def take(self, rows: Bools) -> Cells:
        """Some of the cells."""
        return replace(self, xyz=self.xyz[rows])

    def turned(self, rotation: Floats) -> Cells:
        """The same cells in another frame."""
        return Cells(self.xyz @ rotation.T, self.side, rotation @ self.middle)


def cells_at(xyz: Floats, side: float) -> tuple[Ints, Ints]:
    """The cell (P,) in which each point (P, 3) lies, and how many points each cell holds."""
    _, cell, count = np.unique(
        cubes(np.rint(xyz / side), 1.0), return_inverse=True, return_counts=True
    )
    return cell, count


@dataclass(frozen=True, eq=False, kw_only=True)
class Patches:
    """What lies around some cells: variances (C, 3) ascending, and their axes (C, 3, 3), columns.

    The principal components (PCA) of what is near each.

    `xyz` (C, 3) are the cells, `count` (C,) how many cells lie around each.
    """

    xyz: Floats
    count: Ints
    variance: Floats
    axes: Floats

    @classmethod
    def of(cls, cells: Cells, radius: float) -> Patches:
        """Patches of that radius, metres, around at most `MOST_PATCHES` of the cells."""
        centers = cells.xyz[:: -(-len(cells.xyz) // MOST_PATCHES)]
        start, members = within(cells.xyz, centers, radius)
        count = np.diff(start)
        patch = np.repeat(np.arange(len(centers)), count)
        offsets = cells.xyz[members] - centers[patch]
        mean = _means(patch, offsets, count)
        products = offsets[:, :, None] * offsets[:, None, :]
        moments = _means(patch, products.reshape(-1, 9), count).reshape(-1, 3, 3)
        variance, axes = np.linalg.eigh(moments - mean[:, :, None] * mean[:, None, :])
        return cls(xyz=centers, count=count, variance=np.maximum(variance, 0), axes=axes)

    @cached_property
    def linear(self) -> Floats:
        """How much each patch is a line (C,), 0 to 1."""
        least = np.maximum(self.variance[:, 2], 1e-12)
        return np.asarray((self.variance[:, 2] - self.variance[:, 1]) / least)

    @property
    def directions(self) -> Floats:
        """The direction (C, 3) of each, if it is a line."""
        return np.asarray(self.axes[:, :, 2])

    @property
    def normals(self) -> Floats:
        """The normal (C, 3) of each, if it is flat."""
        return np.asarray(self.axes[:, :, 0])

    def take(self, rows: Bools) -> Patches:
        """Some of the patches."""
        return Patches(
            xyz=self.xyz[rows],
            count=self.count[rows],
            variance=self.variance[rows],
            axes=self.axes[rows],
        )

    def turned(self, rotation: Floats) -> Patches:
        """The same patches in another frame."""
        return Patches(
            xyz=self.xyz @ rotation.T,
            count=self.count,
            variance=self.variance,
            axes=rotation @ self.axes,
        )


def _means(patch: Ints, values: Floats, count: Ints) -> Floats:
    columns = [np.bincount(patch, column, len(count)) / count for column in values.T]
    return np.column_stack(columns)
