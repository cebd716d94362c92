"""`PYTHON run_treeqsm.py IN.npz OUT.npz N N N`: TreeQSM on one cloud, in a Python that has it.

`bench.peers` runs this file in a process of its own; it imports nothing of prunus. IN holds xyz
(P, 3), metres, Z up. PyTLidar's own helper takes N values of PatchDiam1, PatchDiam2Min and
PatchDiam2Max about what it estimates from the foot of the stem, TreeQSM makes a model of each
combination, and the one that its authors' default criterion prefers is kept: the least mean
distance of points from cylinders. OUT holds that model's cylinders (C,): start, axis (C, 3),
length, radius, metres, and the row of the parent, -1 for none. It draws at random, partly from
generators that nothing outside can seed: no two runs are alike.
"""

import sys
from pathlib import Path

import numpy as np
from PyTLidar import build_inputs, calculate_optimal, run_qsm

CRITERION = "all_mean_dis"
COLUMNS = ("start", "axis", "length", "radius", "parent")


def main(source: str, target: str, *counts: str) -> None:
    """Make the models, and write the cylinders of the best."""
    with np.load(source) as held:
        xyz = held["xyz"]
    inputs = build_inputs(xyz, tuple(map(int, counts)), savetxt=0, savepdf=0)[0]
    models, _ = run_qsm(xyz, inputs, str(Path(target).parent))
    best, _, _ = calculate_optimal(models, CRITERION)
    np.savez(target, **{name: models[best]["cylinder"][name] for name in COLUMNS})


if __name__ == "__main__":
    main(*sys.argv[1:])
