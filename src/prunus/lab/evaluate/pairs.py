"""`prunus evaluate`: skeletons against gold standards, one pair or two folders of them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from prunus.editing.edits import edits, label_ratios, on_same_nodes
from prunus.errors import NoTreeError, PrunusError
from prunus.files.work_folder import CORRECTED, SKELETON
from prunus.io.records import PairRecord
from prunus.io.skeletons.lines import READERS, checked_length, read_lines
from prunus.io.skeletons.skeleton_file import read_skeleton
from prunus.io.tables import without_nan
from prunus.lab.evaluate.curves import curve_measures, line_measures
from prunus.lab.evaluate.found import branch_measures
from prunus.model import Floats, Label, Lines, Skeleton
from prunus.names import as_text

Record = dict[str, Any]
Pair = tuple[str, Path, Path]
"""The name of a pair, the skeleton, the gold standard."""


def pairs_in(skeletons: Path, gold: Path) -> list[Pair]:
    """Name, skeleton and gold standard of each pair; in folders those of the same name.

    A file has its own name, and `NAME/skeleton.json` or `NAME/truth.json` that of its folder. A
    gold standard is what a person corrected, where there is any: `NAME/corrected.json`.
    Raises PrunusError where a gold standard has no skeleton, or there is none.
    """
    if not skeletons.is_dir() and not gold.is_dir():
        return [(as_text(skeletons), skeletons, gold)]
    if skeletons.is_dir() != gold.is_dir():
        raise PrunusError(f"{skeletons} and {gold}: expected two files or two folders")
    ours, theirs = _named(skeletons, "skeleton"), _gold_in(gold)
    if not theirs:
        raise PrunusError(
            f"{gold}: no gold standard in it; expected NAME/corrected.json, NAME/truth.json, or "
            f"NAME with one of {' '.join(sorted(READERS))}"
        )
    missing = sorted(set(theirs) - set(ours))
    if missing:
        raise PrunusError(f"{skeletons}: no skeleton {missing[0]!r}, which {gold} has")
    return [(as_text(name), ours[name], theirs[name]) for name in sorted(theirs)]


def _gold_in(folder: Path) -> dict[str, Path]:
    """The gold standards in a folder by name.

    Beside trees that were corrected, one that was not has no gold standard: the machine's own
    skeleton would be right by definition.
    """
    named = _named(folder, "corrected", "truth", "gold", "skeleton")
    if not any(path.name == CORRECTED for path in named.values()):
        return named
    return {name: path for name, path in named.items() if path.name != SKELETON}


def _named(folder: Path, *stems: str) -> dict[str, Path]:
    """The skeleton files in a folder by name; `stems` are looked for in the folders below it."""
    found = {p.stem: p for p in sorted(folder.iterdir()) if p.suffix.lower() in READERS}
    for below in sorted(path for path in folder.iterdir() if path.is_dir()):
        held = [path for stem in stems if (path := below / f"{stem}.json").exists()]
        if held:
            found[below.name] = held[0]
    return found


def compare(name: str, predicted: Path, gold: Path) -> Record:
    """All measures of one pair; `labels` says whether both have them.

    Curve and branch measures; `edit_ratio` and the edits where both stand on the same superpoints.
    Without labels the geometry alone. A measure of nothing is None.
    """
    ours, theirs = _labelled(predicted), _labelled(gold)
    if theirs is not None and len(theirs) == 1:
        raise NoTreeError(f"{gold}: holds a base alone; expected a tree to measure against")
    if ours is None or theirs is None:
        measures = line_measures(read_lines(predicted), read_lines(gold))
        return _record({"name": name, "labels": False, **measures})
    record: Record = {"name": name, "labels": True}
    both = on_same_nodes(ours, theirs)
    if both is not None:
        needed = edits(*both)
        record |= {"edit_ratio": needed.ratio, "wrong": needed.wrong, "missing": needed.missing,
                   "mislabelled": needed.mislabelled, "edges": needed.edges}  # fmt: skip
        ratios = label_ratios([needed])
        record |= {f"{label.word}_edit_ratio": ratios[label][0] for label in Label}
    return _record(record | curve_measures(ours, theirs) | branch_measures(ours, theirs))


def _record(measures: Record) -> Record:
    return PairRecord.model_validate(without_nan(measures)).model_dump()


def strangers(pairs: list[Pair], records: list[Record]) -> list[str]:
    """A hint for each pair of which nothing of one lies by the other: zeros tell nothing then."""
    return [
        f"{name}: nothing of one lies by the other: {_apart(ours, theirs)}; expected two skeletons "
        "of one tree, in one frame and unit"
        for (name, ours, theirs), record in zip(pairs, records, strict=True)
        if not record["geometry_recall"] and not record["geometry_precision"]
    ]


def _apart(predicted: Path, gold: Path) -> str:
    """How far two skeletons are from each other, and how much larger one is, in words."""
    ours, theirs = (_some_nodes(path) for path in (predicted, gold))
    nearest = min(float(np.linalg.norm(theirs - node, axis=1).min()) for node in ours)
    sizes = [float(np.linalg.norm(np.ptp(nodes, axis=0))) for nodes in (ours, theirs)]
    larger = max(sizes) / max(min(sizes), 1e-9)
    words = f"the nearest nodes are {nearest:.2f} m apart"
    return f"{words}, and one is {larger:.0f} times as large" if larger > OTHER_UNIT else words


def _some_nodes(path: Path) -> Floats:
    """At most `LOOKED_AT` nodes of a skeleton file."""
    nodes = (_labelled(path) or read_lines(path)).xyz
    return nodes[:: -(-len(nodes) // LOOKED_AT)]


OTHER_UNIT, LOOKED_AT = 5.0, 2000
"""Two skeletons of which one is so much larger are in two units; so many nodes are looked at."""


def _labelled(path: Path) -> Skeleton | None:
    """The skeleton of a file of ours; None where another tool wrote it."""
    if path.suffix.lower() not in (".json", ".swc"):
        return None
    try:
        skeleton = read_skeleton(path)
    except PrunusError:
        if path.suffix.lower() == ".swc":
            return None
        raise
    checked_length(Lines(skeleton.xyz, skeleton.edges), path)
    return skeleton


def spread_lines(records: list[Record]) -> list[str]:
    """A line a measure: median, quartiles, best and worst over the pairs, and how many have it.

    A measure without a value is None, see `io.tables.without_nan`.
    """
    names = [n for n in dict.fromkeys(k for r in records for k in r) if n not in ("name", "labels")]
    lines = [f"{'':<28} {'median':>9} {'quartiles':>19} {'least':>9} {'most':>9} {'pairs':>6}"]
    for name in names:
        known = [r[name] for r in records if r.get(name) is not None]
        if known:
            low, middle, high = np.quantile(known, [0.25, 0.5, 0.75])
            lines.append(
                f"{name:<28} {middle:9.3f} {low:9.3f} {high:9.3f} {min(known):9.3f} "
                f"{max(known):9.3f} {len(known):6d}"
            )
        else:
            lines.append(f"{name:<28} {'-':>9}")
    return lines
