"""`python -m bench.frame [--trees 24] [--seed 950000]`: up and the row, found without help.

Hand-cleaned trees (their points alone), and simulated field rows as they stand and each turned at
random: about Z by up to 180 degrees, about the row by up to 15, about the line of sight by up to 8.
Then every axis of the file as up, with floors of half, three quarters and nine tenths of all
points, for a tenth of the trees and one drawn tree of each habit.
"""

from __future__ import annotations

import argparse
import math
from collections import Counter

import numpy as np

from bench.shapes import HABITS, scanned, with_floor
from prunus.frames.orient import UPWARD
from prunus.frames.stance import find_stance
from prunus.lab.simulate.scan import simulate_scan
from prunus.model import FRAMES, Floats, Kind
from prunus.model.rotations import turned

ABOUT = (15.0, 8.0, 180.0)
"""Degrees about X (the row), Y (the line of sight) and Z, at most."""
SHARES = (0.0, 0.5, 0.75, 0.9)
LEVEL_DEG = 3.0
"""Up is found when it is so near to right."""


def errors(xyz: Floats, askew: Floats) -> tuple[float, float, bool]:
    """Degrees by which up and the row are wrong after a scan was turned by (3, 3) and set right.

    The row has no direction: half a turn is right as well. And whether a warning names the axis.
    """
    stance = find_stance(xyz @ askew.T)
    left = stance.turn @ FRAMES[stance.frame] @ askew
    up = math.degrees(math.acos(np.clip(left[2, 2], -1, 1)))
    row = math.degrees(math.atan2(left[1, 0], left[0, 0]))
    return up, abs((row + 90) % 180 - 90), stance.notes[0].startswith("undecided")


def random_turn(seed: int) -> Floats:
    """A rotation (3, 3) within `ABOUT`."""
    rng = np.random.default_rng(seed)
    x, y, z = (turned(np.radians(rng.uniform(-most, most)) * np.eye(3)[axis])
               for axis, most in enumerate(ABOUT))  # fmt: skip
    return np.asarray(z @ y @ x)


def told(name: str, found: list[tuple[float, float, bool]]) -> None:
    """Print what came out for some scans."""
    up, row, doubt = np.array(found, np.float64).T
    print(
        f"{name}: up within {LEVEL_DEG:.0f} degrees {(up <= LEVEL_DEG).mean():.1%}, "
        f"median {np.median(up):.1f}, most {up.max():.1f}; row within 6 {(row <= 6).mean():.1%}, "
        f"within 15 {(row <= 15).mean():.1%}; undecided {doubt.mean():.1%}"
    )


def floors(trees: list[Floats]) -> None:
    """Print what comes out for each share of floor, over trees and the six axes."""
    for share in SHARES:
        count: Counter[str] = Counter()
        for number, tree in enumerate(trees):
            xyz = with_floor(np.random.default_rng(number), tree, share) if share else tree
            for frame in UPWARD.values():
                up, _, doubt = errors(xyz, FRAMES[frame].T)
                right = "right" if up <= LEVEL_DEG else "wrong"
                count[f"{right}, undecided" if doubt else right] += 1
        print(f"floor {share:4.0%} of the points, six axes:", dict(sorted(count.items())))


def main() -> None:
    """Measure, and print shares."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--trees", type=int, default=24)
    parser.add_argument("--seed", type=int, default=950_000)
    chosen = parser.parse_args()
    seeds = range(chosen.seed, chosen.seed + chosen.trees)
    scans = [simulate_scan(seed) for seed in seeds]
    cleaned = [scan.xyz[scan.kind == Kind.TARGET] for scan in scans]
    told("hand-cleaned trees", [errors(xyz, np.eye(3)) for xyz in cleaned])
    told("rows as they stand", [errors(scan.xyz, np.eye(3)) for scan in scans])
    pairs = zip(scans, seeds, strict=True)
    told("rows turned at random", [errors(scan.xyz, random_turn(seed)) for scan, seed in pairs])
    rng = np.random.default_rng(chosen.seed)
    drawn = [scanned(rng, grow(rng), front=False) for grow in HABITS.values()]
    floors(cleaned[::10] + drawn)


if __name__ == "__main__":
    main()
