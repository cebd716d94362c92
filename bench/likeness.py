"""`python -m bench.likeness REAL.ply`: how like a real scan the simulated field scans are.

Statistics of both at the same number of points, and a small classifier that is shown patches of
20 cm of both and asked which is which (area under the ROC curve; 0.5 is chance). Patches are
split by place: what it is tested on it has never seen, on the real scan as on the simulated ones.
"""

from __future__ import annotations

import argparse
from itertools import pairwise
from pathlib import Path

import numpy as np

from prunus.kernels.neighbours import within
from prunus.model import Bools, Floats
from prunus.simulate import simulate_scan

PATCH = 0.10
"""Radius of a patch, metres."""
QUANTILES = (0.1, 0.25, 0.5, 0.75, 0.9)


def ball_features(xyz: Floats, centres: Floats) -> dict[str, Floats]:
    """What a patch (C,) of points looks like; all lengths in metres."""
    start, members = within(xyz, centres, PATCH)
    rows = [members[a:b] for a, b in pairwise(start)]
    table = [patch(xyz[row], centre) for row, centre in zip(rows, centres, strict=True)]
    return {name: np.array([one[name] for one in table]) for name in table[0]}


def patch(points: Floats, centre: Floats) -> dict[str, float]:
    """Numbers that describe the points (Q, 3) of one patch."""
    middle = points - points.mean(axis=0)
    values, axes = np.linalg.eigh(middle.T @ middle / len(points))
    values = np.sqrt(np.maximum(values, 0))
    axis = axes[:, 2] * np.sign(axes[2, 2] or 1)
    along = middle @ axis
    depth = np.cross(axis, [1.0, 0.0, 0.0])
    depth /= np.linalg.norm(depth) or 1
    across = np.cross(depth, axis)
    filled = np.unique((along / 0.01).astype(int))
    near = np.sort(np.linalg.norm(points[:, None] - points[None, :40], axis=2), axis=0)
    wide, deep = (np.subtract(*np.percentile(middle @ d, [95, 5])) for d in (across, depth))
    tails = np.percentile(np.abs(middle @ depth), [50, 90, 99])
    sides = np.percentile(np.abs(middle @ across), [50, 90, 99])
    return {
        "count": float(len(points)), "long": values[2], "middle": values[1], "thin": values[0],
        "wide": wide, "deep": deep, "upright": axis[2], "lean": -axis[1],
        "gap": float(np.diff(filled).max(initial=1) * 0.01),
        "nearest": float(np.median(near[1])) if len(points) > 1 else PATCH,
        "fifth": float(np.median(near[min(5, len(points) - 1)])),
        "deep90": tails[1] / max(tails[0], 1e-3), "deep99": tails[2] / max(tails[0], 1e-3),
        "wide90": sides[1] / max(sides[0], 1e-3), "wide99": sides[2] / max(sides[0], 1e-3),
        "offset": float(np.linalg.norm(points.mean(axis=0) - centre)),
    }  # fmt: skip


def upright_wood(found: dict[str, Floats]) -> Bools:
    """Patches that hold one upright branch."""
    lone = (found["long"] > 2.0 * found["middle"]) & (found["count"] > 40)
    return lone & (found["upright"] > 0.8)


def centres_of(xyz: Floats, rng: np.random.Generator, count: int) -> Floats:
    """Centres of patches, as superpoints are: means of the balls around random points."""
    start, members = within(xyz, xyz[rng.choice(len(xyz), count)], PATCH)
    return np.array([xyz[members[a:b]].mean(axis=0) for a, b in pairwise(start) if b - a >= 8])


def above_ground(xyz: Floats, ground: float) -> Floats:
    """The points more than 20 cm over the ground."""
    return xyz[xyz[:, 2] > ground + 0.2]


def real_points(path: Path) -> Floats:
    """The real scan (P, 3) in the house frame."""
    from prunus import read_cloud

    cloud = read_cloud(path, frame="optical")
    xyz = cloud.to_input.apply(cloud.xyz) @ np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]]).T
    return np.asarray(xyz - [0, 0, np.percentile(xyz[:, 2], 5)])


def compare(real: Floats, scans: list[Floats], rng: np.random.Generator) -> None:
    """Print quantiles of both, and what the classifier makes of them."""
    ours = [above_ground(scan, 0.0) for scan in scans]
    theirs = above_ground(real, 0.0)
    left = ball_features(theirs, centres_of(theirs, rng, 1500))
    parts = [ball_features(scan, centres_of(scan, rng, 1500 // len(ours))) for scan in ours]
    right = {name: np.concatenate([part[name] for part in parts]) for name in left}
    for name in left:
        a, b = left[name][upright_wood(left)], right[name][upright_wood(right)]
        print(f"{name:9s}", *(f"{np.quantile(a, q):8.4f}" for q in QUANTILES), " | ",
              *(f"{np.quantile(b, q):8.4f}" for q in QUANTILES))  # fmt: skip
    print("upright share", upright_wood(left).mean(), upright_wood(right).mean())


def main() -> None:
    """Read, simulate, compare."""
    parser = argparse.ArgumentParser()
    parser.add_argument("real", type=Path)
    parser.add_argument("-n", type=int, default=12)
    chosen = parser.parse_args()
    rng = np.random.default_rng(0)
    real = real_points(chosen.real)
    scans = []
    for seed in range(5000, 5000 + chosen.n):
        xyz = simulate_scan(seed).xyz
        scans.append(xyz[rng.choice(len(xyz), len(real), replace=False)])
    compare(real, scans, rng)


if __name__ == "__main__":
    main()
