"""What the chain makes of simulated scans, and of what it cannot know, and what of that is right.

Kept in a folder: scans as in `bench.set_cases`, and what came of each for one network and chain.
"""

from __future__ import annotations

import hashlib
import pickle
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

import prunus
from bench.nontrees import NO_TREES
from bench.set_cases import Case, case_of
from bench.shapes import HABITS, scanned
from prunus.errors import PrunusError
from prunus.files.safely import write_bytes
from prunus.lab.evaluate.right import right_branches, right_edges, well_placed_branches
from prunus.model import Bools, Floats, PointCloud
from prunus.pipeline import follow
from prunus.result import Result
from prunus.trust import Known

SETS = {"ordinary": 510_000, "hard": 500_000, "hard_raw": 500_000, "clean": 520_000,
        "any": 2_500_000, "any_raw": 2_500_000}  # fmt: skip
"""Where the seeds of each set begin that the models are fitted to; those of which no network
learned."""
HELD_OUT = 100_000
"""So much later begin those on which they are judged."""
FORMS = tuple(HABITS)
"""Fruit trees of other training forms, drawn otherwise than by our simulators."""
KINDS = tuple(NO_TREES)
MEANT = 0.5
"""Where so large a share of the edges lies on wood of the tree, whatever its label, it was taken
for the one that is meant."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Tried:
    """What came of a scan: right (B,) the branches, unchanged (M - 1,) the edges of the tree.

    wood: it is a tree; form: one whose labels are told; meant: it is the tree that is meant.
    `known` is None where it was refused before anything was known.
    """

    name: str
    known: Known | None
    right: Bools
    unchanged: Bools
    meant: bool
    wood: bool
    form: bool


def tried(name: str, seed: int, cache: Path) -> Tried:
    """What came of the scan of that set, form or kind, and seed."""
    path = cache / f"tried_{name}_{seed}_{_version()}.pickle"
    if not path.exists():
        write_bytes(path, pickle.dumps(_tried(name, seed, cache)))
    found = pickle.loads(path.read_bytes())
    assert isinstance(found, Tried)
    return found


def _tried(name: str, seed: int, cache: Path) -> Tried:
    case = case_of(name, seed, cache) if name in SETS else None
    result = result_of(drawn(name, seed) if case is None else case.xyz)
    nothing = np.zeros(0, np.bool_)
    if result is None or result.told is None or len(result.in_house) < 3:
        return Tried(name=name, known=None, right=nothing, unchanged=nothing, meant=False,
                     wood=name not in KINDS, form=name in SETS)  # fmt: skip
    known = Known(result.in_house, result.told)
    if case is None:
        return Tried(name=name, known=known, right=nothing, unchanged=nothing, meant=True,
                     wood=name not in KINDS, form=False)  # fmt: skip
    right, unchanged, meant = _judged(result, case)
    return Tried(name=name, known=known, right=right, unchanged=unchanged, meant=meant,
                 wood=True, form=case.has_roles)  # fmt: skip


def _judged(result: Result, case: Case) -> tuple[Bools, Bools, bool]:
    geometry = right_edges(result.skeleton, case.truth, labelled=False)
    meant = bool(geometry.mean() >= MEANT)
    if not case.has_roles:
        return well_placed_branches(result.skeleton, case.truth), geometry, meant
    right = right_branches(result.skeleton, case.truth)
    return right, right_edges(result.skeleton, case.truth), meant


def result_of(xyz: Floats) -> Result | None:
    """What the chain makes of points (P, 3), with no option; None where it refuses them."""
    try:
        return follow(PointCloud.from_xyz(xyz))
    except PrunusError:
        return None


def drawn(name: str, seed: int) -> Floats:
    """The points (P, 3) of what is no tree, or of a fruit tree of another form."""
    rng = np.random.default_rng(seed)
    if name in NO_TREES:
        return NO_TREES[name](rng)
    return scanned(rng, HABITS[name](rng), front=bool(rng.integers(2)))


def all_tried(name: str, count: int, cache: Path, after: int = 0) -> Iterator[Tried]:
    """What came of so many, as they come; `after`: from so much later a seed on."""
    first = SETS.get(name, 0) + after
    for seed in range(first, first + count):
        yield tried(name, seed, cache)


@cache
def _version() -> str:
    """Changes with the networks, the chain, and what is said to be right."""
    home = Path(prunus.__file__).parent
    digest = hashlib.sha256()
    for network in ("field", "owner"):
        digest.update((home / "weights" / f"{network}.onnx").read_bytes())
    for room in ("field", "growth", "lab/evaluate"):
        for path in sorted((home / room).glob("*.py")):
            digest.update(path.read_bytes())
    for path in (Path(__file__), Path(__file__).with_name("nontrees.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:8]
