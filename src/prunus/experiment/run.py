"""All trials of an experiment, tree by tree, resumed where they were stopped."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context
from pathlib import Path

from prunus import __version__
from prunus.errors import PrunusError
from prunus.experiment.edges import edge_record
from prunus.experiment.orchard import tree_of
from prunus.experiment.trial import Record, Way, trial, ways
from prunus.io.safely import read_bytes, write_bytes
from prunus.simulate.settings import Setting

FIRST_SEED = 900_000
"""The trees of the experiment: nothing was ever trained or tuned on seeds from here on."""


def run_trees(
    folder: Path, seeds: range, draws: int, setting: Setting, ablation: bool, jobs: int
) -> Iterator[Record]:
    """What was measured of each tree, in order: `seed`, `trials`, `edges`.

    Each is kept in `folder`/trees as it is done, and read from there when it was done before by
    the same parameters and the same version.
    """
    make = partial(run_tree, folder, draws=draws, setting=setting, ablation=ablation)
    if jobs == 1:
        yield from map(make, seeds)
        return
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        yield from pool.map(make, seeds)


def run_tree(
    folder: Path, seed: int, draws: int, setting: Setting, ablation: bool = False
) -> Record:
    """All trials of one tree."""
    path = folder / "trees" / f"tree_{seed}.json"
    made_by = _made_by(draws, setting, ablation)
    if path.exists():
        held = _read(path)
        if held.get("made_by") == made_by:
            return held
    record = {
        "seed": seed,
        "made_by": made_by,
        "trials": [
            _attempt(seed, draw, way, setting) for draw in range(draws) for way in ways(ablation)
        ],
        "edges": edge_record(seed, setting),
    }
    write_bytes(path, json.dumps(record).encode())
    return record


def _attempt(seed: int, draw: int, way: Way, setting: Setting) -> Record:
    """A trial; where no skeleton comes of it, `error` says why."""
    try:
        return trial(seed, draw, way, setting)
    except PrunusError as error:
        habits = list(tree_of(seed, setting).habits)
        return {"seed": seed, "draw": draw, "way": way.name, "habits": habits,
                "error": str(error)}  # fmt: skip


def _read(path: Path) -> Record:
    try:
        held = json.loads(read_bytes(path))
    except ValueError as error:
        raise PrunusError(f"{path}: not JSON ({error}); remove it to do the tree again") from error
    return held if isinstance(held, dict) else {}


def _made_by(draws: int, setting: str, ablation: bool) -> str:
    """What the trials of a tree depend on, as a short word: version, parameters, weights."""
    digest = hashlib.sha256(f"{__version__} {draws} {setting}".encode())
    for way in ways(ablation):
        digest.update(f"{way.name} {way.oracle} {way.base} {way.params.to_toml()}".encode())
    for weights in sorted((Path(__file__).parents[1] / "weights").iterdir()):
        digest.update(weights.read_bytes())
    return digest.hexdigest()[:16]
