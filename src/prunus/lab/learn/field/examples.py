"""What the point field learns from: simulated scans with their truth, each shown in many ways."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prunus.field.voxels import Voxels, voxels_of
from prunus.io.arrays import read_arrays, write_arrays
from prunus.lab.simulate.scan import Scan
from prunus.lab.simulate.wide.points import PointTruth, point_truth
from prunus.model import Bools, Floats, Ints, Kind, Role
from prunus.model.rotations import turned

FEWEST_POINTS = 2000  # a scan of fewer is left out
MOST_POINTS = 150_000  # of a scan, kept to learn from
POINTS = (12_000, 120_000)  # of a scan as shown, log
ALONE = 0.5  # share of scans of which only the target is shown
SCALE = (0.85, 1.18)
TILT_DEG = 4.0  # standard deviation
GROUND_M = 0.15  # standard deviation of the error of the height of the ground
ANY_WAY = 0.35  # share of scans turned by any angle; the others by up to 20 degrees


@dataclass(frozen=True, eq=False, kw_only=True)
class FieldExample:
    """A scan to learn from: points xyz (P, 3), their kind (P,), and their truth."""

    xyz: Floats
    kind: Ints
    truth: PointTruth

    @classmethod
    def of(cls, scan: Scan, rng: np.random.Generator) -> FieldExample:
        """The example of a simulated scan."""
        return cls(xyz=scan.xyz, kind=scan.kind, truth=point_truth(scan)).thinned(rng)

    @property
    def lacks(self) -> str | None:
        """Why nothing can be learned from it: too few points."""
        return f"{len(self.xyz)} points" if len(self.xyz) < FEWEST_POINTS else None

    def thinned(self, rng: np.random.Generator) -> FieldExample:
        """The example of so many points as are kept to learn from."""
        count = len(self.xyz)
        return self.take(np.sort(rng.choice(count, min(count, MOST_POINTS), replace=False)))

    def take(self, rows: Ints | Bools) -> FieldExample:
        """The example of these points only."""
        truth = PointTruth(
            role=self.truth.role[rows],
            branch=self.truth.branch[rows],
            axis=self.truth.axis[rows],
            radius=self.truth.radius[rows],
            toward_foot=self.truth.toward_foot[rows],
        )
        return FieldExample(xyz=self.xyz[rows], kind=self.kind[rows], truth=truth)

    def write(self, path: Path) -> None:
        """Keep it, in single precision."""
        truth = self.truth
        arrays: dict[str, NDArray[Any]] = {
            "xyz": self.xyz.astype(np.float32),
            "offset": (truth.axis - self.xyz).astype(np.float16),
            "radius": truth.radius.astype(np.float16),
            "toward_foot": truth.toward_foot.astype(np.float16),
            "role": truth.role,
            "branch": truth.branch,
            "kind": self.kind,
        }
        write_arrays(path, arrays, "prunus field example")

    @classmethod
    def read(cls, path: Path) -> FieldExample:
        """Read what `write` wrote."""
        held, _ = read_arrays(path)
        truth = PointTruth(
            role=held["role"],
            branch=held["branch"],
            axis=held["xyz"] + held["offset"],
            radius=held["radius"],
            toward_foot=held["toward_foot"],
        )
        return cls(xyz=held["xyz"], kind=held["kind"], truth=truth)

    def shown(self, rng: np.random.Generator) -> FieldExample:
        """Another view of it: fewer points, the target alone, turned, mirrored, scaled."""
        example = self
        if rng.random() < ALONE and (self.kind == Kind.TARGET).sum() > POINTS[0] // 4:
            example = self.take(self.kind == Kind.TARGET)
        count = round(math.exp(rng.uniform(*np.log(POINTS))))
        if count < len(example.xyz):
            example = example.take(rng.choice(len(example.xyz), count, replace=False))
        return example.moved(motion(rng), rng.uniform(*SCALE))

    def moved(self, motion: Floats, scale: float) -> FieldExample:
        """The example under a rotation or reflection (3, 3), and larger by a scale."""
        truth = self.truth
        moved = PointTruth(
            role=truth.role,
            branch=truth.branch,
            axis=scale * truth.axis @ motion.T,
            radius=scale * truth.radius,
            toward_foot=truth.toward_foot @ motion.T,
        )
        return FieldExample(xyz=scale * self.xyz @ motion.T, kind=self.kind, truth=moved)


def motion(rng: np.random.Generator) -> Floats:
    """A turn about the upright, a little tilt, perhaps a mirror (3, 3)."""
    limit = math.pi if rng.random() < ANY_WAY else math.radians(20)
    about_z = turned(np.array([0.0, 0.0, rng.uniform(-limit, limit)]))
    tilt = turned(np.append(np.radians(rng.normal(0, TILT_DEG, 2)), 0.0))
    mirror = np.diag([*rng.choice([-1.0, 1.0], 2), 1.0])
    return np.asarray(tilt @ about_z @ mirror)


@dataclass(frozen=True, eq=False, kw_only=True)
class Lesson:
    """Voxels with features (V, F), and what is true of the branch that most points of each are of.

    role (V,), offset to the axis (V, 3), radius (V,), metres, and direction to the foot (V, 3).
    """

    voxels: Voxels
    features: Floats
    role: Ints
    offset: Floats
    radius: Floats
    toward_foot: Floats


def lesson_of(example: FieldExample, rng: np.random.Generator | None = None) -> Lesson:
    """The voxels of an example and their truth; with `rng` the grid and the ground vary."""
    voxels = voxels_of(example.xyz, shift=None if rng is None else rng.random(3))
    chosen = _of_most(voxels.of_point, example.truth.branch, len(voxels.xyz))
    voxel = voxels.of_point[chosen]
    weight = np.bincount(voxel, minlength=len(voxels.xyz))

    def mean(values: Floats) -> Floats:
        columns = values[chosen].reshape(len(voxel), -1).T
        sums = [np.bincount(voxel, column, len(weight)) for column in columns]
        return np.asarray(np.column_stack(sums) / weight[:, None])

    role = np.full(len(weight), int(Role.NO_WOOD))
    role[voxel] = example.truth.role[chosen]
    features = voxels.features(0.0 if rng is None else rng.normal(0, GROUND_M))
    return Lesson(
        voxels=voxels,
        features=features,
        role=role,
        offset=mean(example.truth.axis) - voxels.xyz,
        radius=mean(example.truth.radius)[:, 0],
        toward_foot=mean(example.truth.toward_foot),
    )


def _of_most(voxel: Ints, branch: Ints, voxels: int) -> Bools:
    """Which points (P,) are of the branch that most points of their voxel are of."""
    pairs, pair, size = np.unique(
        np.column_stack([voxel, branch]), axis=0, return_inverse=True, return_counts=True
    )
    order = np.lexsort((size, pairs[:, 0]))
    last = np.append(np.diff(pairs[order, 0]) != 0, True)
    return np.isin(pair.ravel(), order[last])
