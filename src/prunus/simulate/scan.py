"""A scan of a true tree: what fused stereo views leave of it (method.md, last section).

Only the side towards the camera (smaller Y), fattened by smear, thin wood missing in patches,
a few stray points. The full orchard row with its cameras is the work of `simulate` to come.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from prunus.model import Bools, Floats, Ints, PointCloud, Skeleton


@dataclass(frozen=True)
class Faults:
    """What is wrong with a scan; metres, shares."""

    points: int = 60_000
    smear: tuple[float, float, float] = (0.024, 0.016, 0.018)
    """Standard deviation by axis: a 2 to 3 cm leader looks 8 to 11 cm wide, 5 to 8 deep."""
    gaps_per_metre: float = 0.25
    gap_radius: tuple[float, float] = (0.025, 0.10)
    thin: float = 0.012
    """Wood of a smaller radius may vanish in patches."""
    stray: float = 0.004
    """Share of the points that lie anywhere in the bounding box."""


def scan_tree(
    truth: Skeleton, rng: np.random.Generator, faults: Faults | None = None
) -> PointCloud:
    """A cloud of a true skeleton with radii, in its frame."""
    faults = faults or Faults()
    rows = np.arange(1, len(truth))
    visible = np.sqrt(truth.radius[rows] + 0.01) * truth.lengths[rows]
    visible *= ~_in_gaps(truth, rows, rng, faults)
    count = round(faults.points * (1 - faults.stray))
    row = rng.choice(rows, count, p=visible / visible.sum())
    share = rng.random((count, 1))
    axis = truth.xyz[row] * share + truth.xyz[truth.parent[row]] * (1 - share)
    surface = axis + truth.radius[row][:, None] * _facing(rng, count)
    smeared = surface + rng.normal(0, faults.smear, (count, 3))
    low, high = truth.xyz.min(axis=0), truth.xyz.max(axis=0)
    stray = rng.uniform(low, high, (faults.points - count, 3))
    return PointCloud.from_xyz(np.concatenate([smeared, stray]))


def _facing(rng: np.random.Generator, count: int) -> Floats:
    """Directions (count, 3) that face the camera at smaller Y."""
    normal = rng.normal(size=(count, 3))
    normal[:, 1] = -np.abs(normal[:, 1])
    return np.asarray(normal / np.linalg.norm(normal, axis=1, keepdims=True))


def _in_gaps(truth: Skeleton, rows: Ints, rng: np.random.Generator, faults: Faults) -> Bools:
    """Which edges of thin wood lie in a patch that the cameras lost."""
    thin = truth.radius[rows] < faults.thin
    total = truth.lengths[rows][thin].sum()
    gaps = rng.poisson(faults.gaps_per_metre * total)
    lost = np.zeros(len(rows), np.bool_)
    for middle in truth.xyz[rng.choice(rows[thin], gaps)] if gaps else []:
        near = np.linalg.norm(truth.xyz[rows] - middle, axis=1) < rng.uniform(*faults.gap_radius)
        lost |= near & thin
    return lost
