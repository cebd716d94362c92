"""All trials of an experiment, tree by tree, resumed where they were stopped."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path

from prunus import __version__
from prunus.errors import PrunusError
from prunus.files.safely import read_bytes, write_bytes
from prunus.lab.experiment.orchard import Subject, Tree
from prunus.lab.experiment.trial import Record, Way, trial, ways
from prunus.processes.workers import in_order
from prunus.weights import WEIGHTS

FIRST_SEED = 900_000
"""The trees of the experiment: nothing was ever trained or tuned on seeds from here on."""

MEASURED = 3
"""Grows with what is measured of a trial, so that no older record stands for a new one."""


def run_trees(
    folder: Path, subjects: Sequence[Subject], draws: int, ablation: bool, jobs: int
) -> Iterator[Record]:
    """What was measured of each tree, in order: `tree`, `trials`, `edges`.

    Each is kept in `folder`/trees as it is done, and read from there when it was done before by
    the same parameters and the same version.
    """
    make = partial(run_tree, folder, draws=draws, ablation=ablation)
    yield from in_order(make, subjects, jobs)


def run_tree(folder: Path, subject: Subject, draws: int, ablation: bool = False) -> Record:
    """All trials of one tree."""
    path = folder / "trees" / f"{subject.name}.json"
    made_by = _made_by(draws, subject.made_of, ablation)
    if path.exists():
        held = _read(path)
        if held.get("made_by") == made_by:
            return held
    tree = subject.tree()
    record = {
        "tree": subject.name,
        "made_by": made_by,
        "trials": [
            *subject.by_hand(),
            *(_attempt(tree, draw, way) for draw in range(draws) for way in ways(ablation)),
        ],
        "edges": subject.edges(),
    }
    write_bytes(path, json.dumps(record).encode())
    return record


def _attempt(tree: Tree, draw: int, way: Way) -> Record:
    """A trial; where no skeleton comes of it, `error` says why."""
    try:
        return trial(tree, draw, way)
    except PrunusError as error:
        return {"tree": tree.name, "draw": draw, "way": way.name, "habits": list(tree.habits),
                "error": str(error)}  # fmt: skip


def _read(path: Path) -> Record:
    try:
        held = json.loads(read_bytes(path))
    except ValueError as error:
        raise PrunusError(f"{path}: not JSON ({error}); remove it to do the tree again") from error
    return held if isinstance(held, dict) else {}


def _made_by(draws: int, made_of: str, ablation: bool) -> str:
    """What the trials of a tree depend on, as a short word: version, parameters, weights."""
    digest = hashlib.sha256(f"{__version__} {MEASURED} {draws} tree {made_of}".encode())
    for way in ways(ablation):
        digest.update(f"{way.name} {way.about} {way.base} {way.params.to_toml()}".encode())
    for weights in sorted(path for path in WEIGHTS.iterdir() if path.is_file()):
        digest.update(weights.read_bytes())
    return digest.hexdigest()[:16]
