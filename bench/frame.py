"""`python -m bench.frame [--rows 40] [--seed 950000]`: up and the row, found without help.

Simulated field rows as they stand, and each turned at random: about Z by up to 25 degrees, about
the row by up to 15, about the line of sight by up to 8.
"""

from __future__ import annotations

import argparse
import math

import numpy as np

from prunus.model import Floats
from prunus.model.rotations import turned
from prunus.sensing.level import find_turn
from prunus.sensing.orient import local_wood
from prunus.simulate.scan import simulate_scan

ABOUT = (15.0, 8.0, 25.0)
"""Degrees about X (the row), Y (the line of sight) and Z, at most."""


def errors(xyz: Floats, askew: Floats) -> tuple[float, float]:
    """Degrees by which up and the row are wrong after a scan was turned by (3, 3) and set right."""
    seen = xyz @ askew.T
    turn, _ = find_turn(seen, local_wood(seen), np.random.default_rng(0))
    left = turn @ askew
    up = math.degrees(math.acos(min(1.0, left[2, 2])))
    return up, abs(math.degrees(math.atan2(left[1, 0], left[0, 0])))


def main() -> None:
    """Measure, and print shares."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--rows", type=int, default=40)
    parser.add_argument("--seed", type=int, default=950_000)
    chosen = parser.parse_args()
    found: dict[str, list[tuple[float, float]]] = {"as they stand": [], "turned": []}
    for seed in range(chosen.seed, chosen.seed + chosen.rows):
        rng = np.random.default_rng(seed)
        about = [turned(np.radians(rng.uniform(-most, most)) * np.eye(3)[axis])
                 for axis, most in enumerate(ABOUT)]  # fmt: skip
        xyz = simulate_scan(seed).xyz
        found["as they stand"].append(errors(xyz, np.eye(3)))
        found["turned"].append(errors(xyz, about[2] @ about[1] @ about[0]))
    for name, pairs in found.items():
        up, row = np.array(pairs).T
        print(f"{name:14} up within 2 degrees {(up <= 2).mean():6.1%}, median {np.median(up):.1f};"
              f"  row within 5 {(row <= 5).mean():6.1%}, median {np.median(row):.1f}")  # fmt: skip


if __name__ == "__main__":
    main()
