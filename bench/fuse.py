"""`python -m bench.fuse [--scans N] [--seed S]`: how well the poses of views are refined.

Simulated field scans, their six depth images in whole millimetres as `prunus simulate --views`
writes them. Two sets of wrong poses: those that the simulated rig believes in (every angle and
shift normal, 0.25 degrees and 7 mm), and drawn ones (about any axis by up to 1 degree, any way by
up to 15 mm, evenly). Poses are known only relative to each other, so before they are compared with
the true ones one rigid motion takes all of them there: the rotation that brings the six
orientations nearest, the shift that brings the middle of the six cameras there.
"""

from __future__ import annotations

import argparse
import time
from itertools import pairwise

import numpy as np

from prunus.fusion.fuse import fuse, merged
from prunus.fusion.views import seen
from prunus.geometry.near import within
from prunus.lab.simulate import Scan, simulate_scan
from prunus.model import Camera, DepthView, Floats, Label, RigidMotion, RigView
from prunus.model.rotations import turn_of, turned

MILLIMETRE = 1e-3


def views_of(scan: Scan, nominal: list[RigidMotion]) -> list[RigView]:
    """The views of a scan with other nominal poses."""
    H, W = scan.views[0].depth.shape
    camera = Camera(fx=scan.focal, fy=scan.focal, cx=W / 2, cy=H / 2)
    steps = [np.rint(view.depth / MILLIMETRE) * MILLIMETRE for view in scan.views]
    both = enumerate(zip(steps, nominal, strict=True))
    return [
        DepthView(name=f"view_{k}", depth=depth, camera=camera, nominal=pose)
        for k, (depth, pose) in both
    ]


def drawn(true: list[RigidMotion], rng: np.random.Generator) -> list[RigidMotion]:
    """Poses that are wrong by up to 1 degree and 15 mm, evenly."""
    ways = rng.normal(size=(2, len(true), 3))
    ways /= np.linalg.norm(ways, axis=2, keepdims=True)
    turns = ways[0] * np.radians(rng.uniform(0, 1, len(true)))[:, None]
    shifts = ways[1] * rng.uniform(0, 0.015, len(true))[:, None]
    return [
        RigidMotion(turned(turn) @ pose.rotation, pose.translation + shift)
        for pose, turn, shift in zip(true, turns, shifts, strict=True)
    ]


def errors(poses: list[RigidMotion], true: list[RigidMotion]) -> Floats:
    """Errors (V, 2) of poses after the best common motion: millimetres and degrees."""
    both = list(zip(poses, true, strict=True))
    left, _, right = np.linalg.svd(sum(right.rotation @ pose.rotation.T for pose, right in both))
    common = left @ np.diag([1, 1, np.linalg.det(left @ right)]) @ right
    turned_ = [RigidMotion(common @ p.rotation, common @ p.translation) for p in poses]
    shift = np.array([t.translation - p.translation for p, t in zip(turned_, true, strict=True)])
    moved = np.linalg.norm(shift - shift.mean(axis=0), axis=1) / MILLIMETRE
    turn = [np.linalg.norm(turn_of(p, t)) for p, t in zip(turned_, true, strict=True)]
    return np.column_stack([moved, np.degrees(turn)])


def widths(scan: Scan, views: list[RigView], poses: list[RigidMotion]) -> Floats:
    """Widths and depths (2, Q) of stretches of the target's leaders in the merged cloud, cm.

    A stretch is what lies within 5 cm of a place on a true leader, one place every 10 cm; width is
    along the row, depth across it, each from the 5th to the 95th percentile.
    """
    xyz, _ = merged([seen(view) for view in views], poses, np.random.default_rng(0))
    tree = scan.row.trees[0]
    on = np.flatnonzero(tree.label == Label.LEADER)
    _, first = np.unique(np.floor(tree.xyz[on] / 0.1).astype(int), axis=0, return_index=True)
    start, near = within(xyz, tree.xyz[on[first]], 0.05)
    balls = [xyz[near[a:b]] for a, b in pairwise(start) if b - a >= 40]
    spread = [np.subtract(*np.percentile(ball[:, :2], [95, 5], axis=0)) for ball in balls]
    return 100 * np.array(spread).T


def row(name: str, found: list[Floats]) -> str:
    """A line on the errors of some poses."""
    off = np.concatenate(found)
    good = np.mean((off[:, 0] <= 2) & (off[:, 1] <= 0.1))
    cells = " ".join(f"{np.quantile(off[:, c], q):8.3f}" for c in (0, 1) for q in (0.5, 0.95))
    return f"{name:18} {good:7.1%} {cells}"


def main() -> None:
    """Simulate, make the poses wrong, refine them, compare."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--scans", type=int, default=10)
    parser.add_argument("--seed", type=int, default=700_000)
    parser.add_argument("--widths", type=int, default=5, help="scans in which width is measured")
    chosen = parser.parse_args()
    found: dict[str, list[Floats]] = {}
    wide: dict[str, list[Floats]] = {}
    spent, refused = [], 0
    for seed in range(chosen.seed, chosen.seed + chosen.scans):
        scan = simulate_scan(seed)
        true = [view.pose for view in scan.views]
        sets = {
            "rig": [view.nominal for view in scan.views],
            "drawn": drawn(true, np.random.default_rng(seed)),
        }
        for name, nominal in sets.items():
            views = views_of(scan, nominal)
            before = time.process_time()
            fused = fuse(views)
            spent.append(time.process_time() - before)
            poses = [view.pose for view in fused.views]
            refused += sum(bool(view.refused) for view in fused.views)
            found.setdefault(f"{name}, nominal", []).append(errors(nominal, true))
            found.setdefault(f"{name}, refined", []).append(errors(poses, true))
            print(row(f"{seed} {name}", [errors(poses, true)]), flush=True)
            if seed < chosen.seed + chosen.widths:
                kinds = {f"{name}, nominal": nominal, f"{name}, refined": poses, "true": true}
                for kind, placed in kinds.items():
                    wide.setdefault(kind, []).append(widths(scan, views, placed))
    print(f"{'poses':18} {'in both':>7} {'mm 50%':>8} {'95%':>8} {'deg 50%':>8} {'95%':>8}")
    print("\n".join(row(name, errs) for name, errs in sorted(found.items())))
    print(f"views refused: {refused}; CPU seconds a scan: median {np.median(spent):.1f}")
    print("stretches of leaders, cm: width 50 %, 75 %; depth 50 %, 75 %")
    for kind, values in wide.items():
        each = np.concatenate(values, axis=1)
        cells = " ".join(f"{np.quantile(each[c], q):6.2f}" for c in (0, 1) for q in (0.5, 0.75))
        print(f"{kind:18} {cells}")


if __name__ == "__main__":
    main()
