"""The trees of a person's own orchard, with the skeletons that they corrected in the studio.

The studio's work folder has a folder NAME a tree, with the machine's `skeleton.json`, the person's
`corrected.json`, and what was said of its points (`mask.ply`) and edges (`labels.jsonl`).
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from prunus.editing.edits import edits, on_same_nodes
from prunus.errors import PrunusError
from prunus.files.work_folder import CORRECTED, JOURNAL, LABELS, MASK, SKELETON
from prunus.frames.scan import Scan, open_scan
from prunus.io.clouds.classes import target_of
from prunus.io.labels import read_labels
from prunus.io.original import original_of
from prunus.io.skeletons.skeleton_file import Point, SkeletonFile, read_record
from prunus.lab.experiment.edges import judged_edges
from prunus.lab.experiment.habits import habits_of
from prunus.lab.experiment.orchard import Tree
from prunus.lab.experiment.trial import BY_HAND, Record, as_found, edited
from prunus.lab.learn.edges.labelled import labelled_graphs
from prunus.model import PointCloud, Skeleton
from prunus.names import as_text
from prunus.params import Parameters
from prunus.pipeline import follow
from prunus.session.journal import Journal, read_journal, status_of

STEP = 0.02
"""The corrected skeleton is given a node every so many metres, as true trees have them."""
FILES = (CORRECTED, SKELETON, MASK, LABELS, JOURNAL)


@dataclass(frozen=True)
class Corrected:
    """A tree in a work folder, and where scans are looked for (see `io.original`)."""

    folder: Path
    scans: Path | None

    @property
    def name(self) -> str:
        """The folder's name."""
        return as_text(self.folder.name)

    @property
    def made_of(self) -> str:
        """A digest of what people said of it."""
        held = hashlib.sha256()
        for path in (self.folder / name for name in FILES):
            held.update(path.read_bytes() if path.is_file() else b"-")
        return held.hexdigest()

    def opened(self) -> tuple[Skeleton, SkeletonFile, Scan, Journal | None]:
        """The corrected skeleton, frame of the file, what its file says, its scan and journal."""
        path = self.folder / CORRECTED
        gold, record = read_record(path)
        if record.input is None:
            raise PrunusError(f"{path}: input: none; expected the scan that it was made from")
        journal = read_journal(self.folder / JOURNAL)
        frame, unit = ("auto", None) if journal is None else (journal.head.frame, journal.head.unit)
        source = original_of(record.input, self.folder, self.scans)
        return gold, record, open_scan(source, frame, unit), journal

    def tree(self) -> Tree:
        """The points that are the tree, and the corrected skeleton as its truth."""
        return _tree(self)

    def by_hand(self) -> list[Record]:
        """The machine's skeleton against what a person made of it, on the same superpoints.

        Nothing where the two do not stand on the same ones, or the machine's was not kept.
        """
        path = self.folder / SKELETON
        if not path.exists():
            return []
        tree, machine = self.tree(), read_record(path)[0]
        both = on_same_nodes(machine, read_record(self.folder / CORRECTED)[0])
        if both is None:
            return []
        return [
            {
                "tree": self.name, "way": BY_HAND, "habits": list(tree.habits),
                **edited(edits(*both)), **as_found(machine, tree),
            }
        ]  # fmt: skip

    def edges(self) -> dict[str, Any]:
        """The network on the edges that were labelled; empty where none were."""
        path = self.folder / LABELS
        held = read_labels(path) if path.exists() else None
        if held is None or not held.labels:
            return {}
        graphs = [(made.candidates, told) for made, told in labelled_graphs(held, self.scans)[0]]
        return judged_edges(graphs)


def corrected_in(folder: Path, scans: Path | None = None) -> tuple[list[Corrected], list[str]]:
    """The corrected trees of a work folder, by name, and the names of those still in work.

    Where the studio keeps a journal, only trees that are marked done are taken.
    Raises PrunusError where there are none.
    """
    if not folder.is_dir():
        raise PrunusError(f"{folder}: no folder; expected the work folder of `prunus studio`")
    found = sorted(path.parent for path in folder.glob("*/corrected.json"))
    done = [Corrected(own, scans) for own in found if _is_done(own)]
    if not done:
        raise PrunusError(
            f"{folder}: {len(found)} corrected trees, none of them done; expected "
            "NAME/corrected.json, and in the studio the tree marked as done"
        )
    return done, sorted({own.name for own in found} - {one.name for one in done})


def _is_done(folder: Path) -> bool:
    """Whether the last word on a tree is that it is done; trees without a journal are."""
    return not (folder / JOURNAL).exists() or status_of(folder) == "done"


@lru_cache(maxsize=4)
def _tree(subject: Corrected) -> Tree:
    gold, record, scan, journal = subject.opened()
    base = None if journal is None else journal.head.base
    mask = subject.folder / MASK
    if mask.exists():
        cloud = scan.cloud.take(target_of(mask, len(scan.cloud)))
    else:
        params = Parameters.of_record(record.params or {}, str(subject.folder / CORRECTED))
        cloud = _isolated(scan.cloud, base, params, record.seed or 0)
    truth = with_nodes_every(gold, STEP)
    habits = habits_of(truth.moved(scan.cloud.to_input.inverse()))
    return Tree(
        name=subject.name,
        cloud=cloud,
        truth=truth,
        counts=np.ones(len(truth), np.bool_),
        habits=habits,
    )


def _isolated(cloud: PointCloud, base: Point | None, params: Parameters, seed: int) -> PointCloud:
    """The points that the chain took for the tree, and nobody said otherwise."""
    isolated = follow(cloud, base, params, seed).isolated
    return cloud if isolated is None else cloud.take(isolated.target)


def with_nodes_every(skeleton: Skeleton, step: float) -> Skeleton:
    """The same skeleton with a node at least every so many metres."""
    xyz, parent, label = [skeleton.xyz[:1]], [-1], [int(skeleton.label[0])]
    row_of = [0]
    for row in range(1, len(skeleton)):
        above = int(skeleton.parent[row])
        pieces = max(1, int(np.ceil(skeleton.lengths[row] / step)))
        share = np.arange(1, pieces + 1)[:, None] / pieces
        xyz.append(skeleton.xyz[above] * (1 - share) + skeleton.xyz[row] * share)
        first = len(parent)
        parent += [row_of[above], *range(first, first + pieces - 1)]
        label += [int(skeleton.label[row])] * pieces
        row_of.append(len(parent) - 1)
    return Skeleton.build(np.concatenate(xyz), parent, label)
