"""`python -m bench.isolate [--rows 40] [--seed 950000]`: one tree out of simulated field rows.

Of each row, never used for learning or tuning: the shares of points kept and taken out, how far the
foot is from the lowest point of the trunk that the scan holds, what a clean tree loses, CPU time,
and the edit ratio of the chain from the raw scan against that from the true points and base.
"""

from __future__ import annotations

import argparse
import math
import time

import numpy as np

from prunus.evaluate.correction import corrected
from prunus.evaluate.edits import edits
from prunus.experiment.orchard import Tree, tree_of
from prunus.model import FRAMES, Kind, PointCloud
from prunus.params import Parameters
from prunus.pipeline import skeletonize
from prunus.result import Result
from prunus.sensing.isolate import isolate, look_at
from prunus.sensing.stance import find_stance
from prunus.simulate.scan import simulate_scan
from prunus.workers import in_order

THINGS = (Kind.POST, Kind.WIRE)
Record = dict[str, float]


def measured(seed: int) -> Record:
    """All figures of one row."""
    scan = simulate_scan(seed)
    cloud = PointCloud.from_xyz(scan.xyz)
    cpu = time.process_time()
    found = isolate(look_at(cloud, Parameters.learned(), np.random.default_rng(0)), None)
    cpu = time.process_time() - cpu
    target, things = scan.kind == Kind.TARGET, np.isin(scan.kind, THINGS)
    clean = PointCloud.from_xyz(scan.xyz[target])
    alone = isolate(look_at(clean, Parameters.learned(), np.random.default_rng(0)), None)
    stance = find_stance(scan.xyz)
    turn = stance.turn @ FRAMES[stance.frame]
    tree = tree_of(seed)
    base = tree.truth.xyz[0]
    record = {
        "points": float(len(scan.xyz)),
        "kept": float(found.target[target].mean()),
        "taken out": float((~found.target[~target]).mean()),
        "foot": float(np.linalg.norm(cloud.to_input.apply(found.foot) - base)),
        "clean tree lost": alone.removed,
        "up": math.degrees(math.acos(min(1.0, turn[2, 2]))),
        "row": abs(math.degrees(math.atan2(turn[0, 1], turn[0, 0]))),
        "cpu": cpu,
        "ratio, raw": ratio(skeletonize(scan.xyz), tree),
        "ratio, true points and base": ratio(skeletonize(tree.cloud, base), tree),
    }
    for kind in Kind:
        held = scan.kind == kind
        if held.any():
            record[f"{kind.name.lower()} taken out"] = float((~found.target[held]).mean())
    if things.any():
        record["wires and posts taken out"] = float((~found.target[things]).mean())
    return record


def ratio(result: Result, tree: Tree) -> float:
    """The edits that a result needs, an edge of the corrected skeleton."""
    nodes = result.graph.superpoints.cloud.to_input.apply(result.graph.xyz)
    return edits(result.skeleton, corrected(result.skeleton, nodes, tree.truth, tree.counts)).ratio


def main() -> None:
    """Measure, and print medians, means and worst."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--rows", type=int, default=40)
    parser.add_argument("--seed", type=int, default=950_000)
    chosen = parser.parse_args()
    seeds = range(chosen.seed, chosen.seed + chosen.rows)
    records = list(in_order(measured, seeds, 2))
    for name in dict.fromkeys(name for record in records for name in record):
        values = np.array([record[name] for record in records if name in record])
        low, middle, high = np.nanquantile(values, [0.1, 0.5, 0.9])
        print(f"{name:30} mean {np.nanmean(values):9.3f}  median {middle:9.3f}  "
              f"10 % {low:9.3f}  90 % {high:9.3f}")  # fmt: skip
    feet = np.array([record["foot"] for record in records])
    found = np.array([record["kept"] > 0.5 for record in records])
    print(f"the target chosen: {found.mean():.3f}; foot within 3 cm: {(feet < 0.03).mean():.3f}")
    for name in ("kept", "taken out"):
        values = np.array([record[name] for record in records])
        print(f"{name}, of the rows where the target was chosen: {values[found].mean():.4f}")


if __name__ == "__main__":
    main()
