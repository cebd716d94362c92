"""The trees that methods are judged on, set by set, kept on disk once they are made."""

from __future__ import annotations

import hashlib
import io
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

import prunus
from bench.drawn_ufo import all_round, one_side
from prunus.files.safely import write_bytes
from prunus.lab.experiment.orchard import target_of
from prunus.lab.simulate.scan import Scan, simulate_scan
from prunus.lab.simulate.wide.scan import simulate_wide
from prunus.model import Bools, Floats, Kind, Label, Skeleton


@dataclass(frozen=True, eq=False)
class Case:
    """One cloud xyz (P, 3) and its truth; `target` (P,) are the points of the tree.

    counts (M,): rows of the true tree that count, see `counting_rows`; wires (W, 3): a
    point every centimetre of them. A tree without leaders has no roles to tell: geometry alone.
    """

    name: str
    xyz: Floats
    target: Bools
    truth: Skeleton
    counts: Bools
    wires: Floats

    @property
    def has_roles(self) -> bool:
        """Whether its labels are those of a UFO tree."""
        return bool((self.truth.label == Label.LEADER).any())

    def cut_out(self) -> Case:
        """The points of the tree alone, as a person would cut them out."""
        alone = self.xyz[self.target]
        return replace(self, xyz=alone, target=np.ones(len(alone), np.bool_))


@dataclass(frozen=True)
class TreeSet:
    """How its scans are made, its first seed, how many; raw: with all that is in view."""

    about: str
    scan: Callable[[int], Scan]
    first: int
    trees: int = 10
    raw: bool = False


def hard(seed: int) -> Scan:
    """The scan of the hard setting."""
    return simulate_scan(seed, "hard")


def ordinary(seed: int) -> Scan:
    """The scan of the paper's own orchard."""
    return simulate_scan(seed, "ordinary")


def clean(seed: int) -> Scan:
    """The scan of the clean setting."""
    return simulate_scan(seed, "clean")


SETS = {
    "straight": TreeSet("textbook UFO trees, all round, 50 000 points, 1 mm", all_round, 0, 8),
    "straight_side": TreeSet(
        "the same one-sided, 4 mm, 25 holes, two wires, strays", one_side, 0, 8, raw=True
    ),
    "ordinary": TreeSet(
        "simulate_scan 'ordinary'; the tree's own points, cut out by hand", ordinary, 900_000
    ),
    "hard": TreeSet("simulate_scan 'hard'; the tree's own points, cut out by hand", hard, 900_000),
    "hard_raw": TreeSet("the same rows, nothing cut out", hard, 900_000, raw=True),
    "clean": TreeSet("simulate_scan 'clean', nothing cut out", clean, 900_000, raw=True),
    "any": TreeSet("simulate_wide; the tree's own points", simulate_wide, 1_000_000),
    "any_raw": TreeSet("the same, nothing cut out", simulate_wide, 1_000_000, raw=True),
}


def case_of(name: str, seed: int, cache: Path | None) -> Case:
    """The case of a set and a seed, from the cache where it is in it."""
    chosen = SETS[name]
    made_by = chosen.scan.__name__
    path = cache and cache / f"{made_by}_{seed}_{_version()}.npz"
    if path is None:
        case = _made(f"{made_by}_{seed}", chosen.scan(seed))
    else:
        if not path.exists():
            write_bytes(path, _packed(_made(f"{made_by}_{seed}", chosen.scan(seed))))
        case = _unpacked(f"{made_by}_{seed}", path)
    return case if chosen.raw else case.cut_out()


def _made(name: str, scan: Scan) -> Case:
    tree = target_of(scan, name)
    return Case(name, scan.xyz, scan.tree == 0, tree.truth, tree.counts, _wires(scan))


def _wires(scan: Scan) -> Floats:
    pieces = scan.row.pieces
    own = pieces.kind == Kind.WIRE
    start, end = pieces.start[own], pieces.end[own]
    share = np.linspace(0, 1, 11)[:, None, None]
    return np.asarray((start + share * (end - start)).reshape(-1, 3))


def _version() -> str:
    """Changes with whatever makes the cases."""
    home = Path(prunus.__file__).parent
    digest = hashlib.sha256()
    made_by = home / "lab" / "simulate"
    for path in sorted([*made_by.rglob("*.py"), *made_by.rglob("*.toml")]):
        digest.update(path.read_bytes())
    for path in (home / "lab" / "evaluate" / "seen.py", Path(__file__).with_name("drawn_ufo.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:8]


TREE = ("xyz", "parent", "label", "radius")


def _packed(case: Case) -> bytes:
    held = io.BytesIO()
    truth = {f"truth_{name}": getattr(case.truth, name) for name in TREE}
    columns = {name: getattr(case, name) for name in ("xyz", "target", "counts", "wires")}
    np.savez_compressed(held, **truth, **columns)
    return held.getvalue()


def _unpacked(name: str, path: Path) -> Case:
    with np.load(path) as held:
        xyz, parent, label, radius = (held[f"truth_{column}"] for column in TREE)
        truth = Skeleton.build(xyz, parent, label, radius=radius)
        return Case(name, held["xyz"], held["target"], truth, held["counts"], held["wires"])
