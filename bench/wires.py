"""`python -m bench.wires [--trees 20] [--seed 950000]`: what two wires through a tree cost.

Each wire is 3 m long, level, along the row, 0.75 and 1.25 m above the lowest point and through the
middle of the points at that height, sampled like a branch: 3000 points, sigma 12 mm. Metres of
skeleton that lie along a wire, and what is found, with the wires and without.
"""

from __future__ import annotations

import argparse

import numpy as np

from prunus.evaluate.found import branch_measures
from prunus.experiment.orchard import tree_of
from prunus.measure import shown
from prunus.model import Floats, Skeleton
from prunus.params import Parameters
from prunus.pipeline import skeletonize

LONG, POINTS, SIGMA = 3.0, 3000, 0.012
HEIGHTS = (0.75, 1.25)
BESIDE, ALONG = 0.04, 0.8
"""An edge lies along a wire when its middle is within so many metres and its cosine is so large."""


def wires_through(xyz: Floats, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Points (Q, 3) of the wires through a tree, and the middle (2, 3) of each."""
    middles = []
    for height in HEIGHTS:
        z = xyz[:, 2].min() + height
        level = np.abs(xyz[:, 2] - z) < 0.1
        middles.append([np.median(xyz[:, 0]), np.median(xyz[level if level.any() else ..., 1]), z])
    along = np.linspace(-LONG / 2, LONG / 2, POINTS)
    points = [
        np.array(middle)
        + np.column_stack([along, *rng.normal(0, SIGMA, (2, POINTS))])
        for middle in middles
    ]  # fmt: skip
    return np.concatenate(points), np.array(middles)


def metres_along(skeleton: Skeleton, middles: Floats) -> float:
    """Metres of a skeleton that lie along the wires."""
    ends = skeleton.xyz[skeleton.edges]
    middle, length = ends.mean(axis=1), skeleton.lengths[1:]
    runs = np.abs(ends[:, 1, 0] - ends[:, 0, 0]) > ALONG * length
    away = np.linalg.norm(middle[:, None, 1:] - middles[None, :, 1:], axis=2).min(axis=1)
    return float(length[runs & (away < BESIDE)].sum())


def main() -> None:
    """Measure, and print a line a tree."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--trees", type=int, default=20)
    parser.add_argument("--seed", type=int, default=950_000)
    chosen = parser.parse_args()
    params = Parameters.learned().changed("isolation", isolate="never")
    total = np.zeros((2, 4))
    for seed in range(chosen.seed, chosen.seed + chosen.trees):
        tree = tree_of(seed)
        xyz = tree.cloud.to_input.apply(tree.cloud.xyz)
        points, middles = wires_through(xyz, np.random.default_rng(seed))
        for row, cloud in enumerate((xyz, np.concatenate([xyz, points]))):
            skeleton = skeletonize(cloud, tree.truth.xyz[0], params).skeleton
            found = branch_measures(skeleton, shown(tree.truth, tree.counts))
            total[row] += [
                metres_along(skeleton, middles), found["leaders_found"],
                found["side_branches_found"], found["false_side_branches"],
            ]  # fmt: skip
    for name, sums in zip(("without wires", "with two wires"), total, strict=True):
        print(f"{name:15} {sums[0] / chosen.trees:.2f} m a tree lie along the wires' places; found "
              f"{sums[1]:.0f} leaders, {sums[2]:.0f} side branches; "
              f"{sums[3]:.0f} side branches are false")  # fmt: skip


if __name__ == "__main__":
    main()
