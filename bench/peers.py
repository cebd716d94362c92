"""`python -m bench.peers --python PYTHON [--set NAME ...]`: TreeQSM beside prunus, same clouds.

TreeQSM (Raumonen et al. 2013, Remote Sensing 5) makes a cloud of one tree into cylinders. What runs
here is its translation into Python, PyTLidar, under GPL-3.0-only: it is called, in a process of
its own, and nothing of it is part of prunus. It wants a numba and a numpy of its own, so give it an
environment of its own and say with `--python` which. What it cannot do in `--limit` seconds, and
where it crashes, is a row `failed`.

Its chance is a fair one: clouds upright, the tree's own points where prunus gets these, parameters
by its own helper from the tree itself, several of each (`--inputs`), and of the models the one
that its authors' criterion prefers (see `bench.run_treeqsm`). Twelve combinations of patches of 6
to 80 mm, set by hand, were tried on trees that are not in the tables: patches of 30 mm and more
were worse, the best of the others within 0.02 of F1 at 2 cm. Its CPU seconds are those of all its
models, and about 1.5 s in which its process starts.

It knows no trunk, support, leader or side branch: what asks for labels is not in the table.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from bench.cylinders import Cylinders, skeleton_of
from bench.set_cases import Case
from bench.set_figures import Figures, figures_of
from bench.set_methods import Found, Method, method_of
from bench.sets import parser_of, run
from prunus.errors import PrunusError
from prunus.model import Floats, PointCloud, Skeleton

SETS_HERE = ["straight", "straight_side", "ordinary", "hard"]
WITHOUT_LABELS = ("failed", "geometry", "unasked", "f1 2", "f1 5", "base", "wire")
"""The figures that need no labels."""
LIMIT_S = 600.0
INPUTS = (1, 2, 2)
SCRIPT = Path(__file__).with_name("run_treeqsm.py")


def main() -> None:
    """Measure, and print a table a set as it is done."""
    parser = parser_of("python -m bench.peers", ["default"])
    parser.set_defaults(trees=4)
    parser.add_argument("--python", default=sys.executable, help="the Python that has PyTLidar")
    parser.add_argument("--inputs", nargs=3, type=int, default=INPUTS, metavar="N",
                        help="values of each patch diameter that TreeQSM tries")  # fmt: skip
    parser.add_argument("--limit", type=float, default=LIMIT_S, help="seconds a tree, then failed")
    chosen = parser.parse_args()
    lacking = what_lacks(chosen.python)
    if lacking:
        parser.error(lacking)
    methods = {name: method_of(name) for name in chosen.method}
    run(chosen, methods | {"TreeQSM": treeqsm(chosen)}, SETS_HERE, geometry_of)


def what_lacks(python: str) -> str:
    """Why PyTLidar does not run in this Python, and how to get it; empty where it does."""
    try:
        done = _run([python, "-c", "from PyTLidar import run_qsm"], LIMIT_S)
        if done.returncode == 0:
            return ""
        why = _why(done)
    except (OSError, subprocess.TimeoutExpired) as error:
        why = str(error)
    return (
        f"{python} cannot run PyTLidar ({why}). It needs Python 3.8 to 3.12 and an environment of "
        "its own: `python3.12 -m venv ENV`, `ENV/bin/pip install pytlidar`, then "
        "`--python ENV/bin/python`"
    )


def treeqsm(chosen: argparse.Namespace) -> Method:
    """TreeQSM as a method of the table, as the options have it; it takes no base."""

    def method(cloud: PointCloud, base: Floats | None) -> Skeleton:
        cylinders = cylinders_of(cloud.xyz, chosen.python, chosen.inputs, chosen.limit)
        return skeleton_of(cylinders).moved(cloud.to_input)

    return method


def cylinders_of(xyz: Floats, python: str, inputs: Sequence[int], limit_s: float) -> Cylinders:
    """What TreeQSM in that Python makes of points (P, 3).

    Raises PrunusError where it fails, or is not done in `limit_s` seconds.
    """
    with tempfile.TemporaryDirectory() as folder:
        source, target = Path(folder, "cloud.npz"), Path(folder, "cylinders.npz")
        np.savez(source, xyz=xyz)
        try:
            done = _run([python, SCRIPT, source, target, *map(str, inputs)], limit_s)
        except subprocess.TimeoutExpired as error:
            raise PrunusError(f"TreeQSM: not done in {limit_s:.0f} s") from error
        if done.returncode != 0:
            raise PrunusError(f"TreeQSM: {_why(done)}")
        with np.load(target) as held:
            sizes = {
                name: held[name].astype(float) for name in ("start", "axis", "length", "radius")
            }
            return Cylinders(**sizes, parent=held["parent"].astype(np.int64))


def _run(words: Sequence[str | Path], limit_s: float) -> subprocess.CompletedProcess[str]:
    return subprocess.run(words, capture_output=True, text=True, timeout=limit_s, check=False)


def _why(done: subprocess.CompletedProcess[str]) -> str:
    """The first error that it names: what follows from it comes after."""
    named = re.search(r"^\w+(?:Error|Exception)\b.*", done.stderr, re.MULTILINE)
    return named[0] if named else f"it ended with {done.returncode}"


def geometry_of(case: Case, found: Found | None) -> Figures:
    """What of the figures of a case needs no labels."""
    figures = figures_of(case, found)
    return {name: figures[name] for name in WITHOUT_LABELS if name in figures}


if __name__ == "__main__":
    main()
