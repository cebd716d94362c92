"""What a network learns from: simulated trees, trees of which a person labelled edges, or both.

Where there are labels, they decide: they alone validate and test, since what counts is how the
network does on scans like these; simulated trees are then all learned from.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from prunus.errors import PrunusError
from prunus.io.labels import labels_in
from prunus.lab.learn.edges.examples import SPLIT, Example, examples_of, split_by_tree
from prunus.lab.learn.edges.labelled import LabelledTree, labelled_trees, split_by_edge
from prunus.lab.simulate.scan_folder import scans_in
from prunus.params import Cover

Item = TypeVar("Item")
Watch = Callable[[Iterable[Item], str, int], Iterable[Item]]
"""Shows progress: items as they come, under a name, out of so many."""

FEWEST = 5
"""So many labelled trees are split by tree; fewer by edge."""
HARD = (
    "the tables are of labelled edges: where the uncertain ones were asked for first, they are the "
    "hard ones, and most edges are told better"
)
PARTS = ("training", "validation", "test")


@dataclass(frozen=True, eq=False, kw_only=True)
class Lessons:
    """Examples to train on, to validate with, to test on, of so many trees; what to say of them.

    `labels`: how many edges a person labelled in each part; None where all is simulated.
    """

    sets: list[list[Example]]
    trees: list[int]
    labels: list[int] | None = None
    notes: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class Sources:
    """Folders of simulated scans, and files of labels."""

    simulated: list[Path]
    labelled: list[Path]

    @classmethod
    def among(cls, folders: list[Path]) -> Sources:
        """What some folders hold; PrunusError naming one that holds neither."""
        simulated, labelled = list[Path](), list[Path]()
        for folder in folders:
            labels, trees = labels_in(folder), any(folder.glob("*/trees.npz"))
            if not labels and not trees:
                raise PrunusError(
                    f"{folder}: no simulated tree in it and no labels; expected folders as "
                    "`prunus simulate` writes them, or the studio's with NAME/labels.jsonl"
                )
            labelled += labels
            simulated += scans_in(folder) if trees else []
        return cls(simulated, labelled)


def lessons_from(
    sources: Sources,
    scans: Path | None,
    seed: int,
    jobs: int,
    cover: Cover,
    *,
    watch: Watch[Any],
    rng: np.random.Generator,
) -> Lessons:
    """The examples; `scans` is where the labelled scans lie, None = looked for."""
    if not sources.labelled:
        parts = split_by_tree(sources.simulated, rng)
        sets = [
            _simulated(own, seed, jobs, cover, watch, f"{what} examples")
            for own, what in zip(parts, PARTS, strict=True)
        ]
        return Lessons(sets=sets, trees=[len(own) for own in parts])
    made = labelled_trees(sources.labelled, seed, jobs, scans)
    trees = list(watch(made, "labelled trees", len(sources.labelled)))
    told = _labelled(trees, rng)
    more = _simulated(sources.simulated, seed, jobs, cover, watch, "simulated examples")
    training, *rest = told.sets
    count, *counts = told.trees
    return Lessons(
        sets=[training + more, *rest],
        trees=[count + len(sources.simulated), *counts],
        labels=told.labels,
        notes=told.notes,
    )


def _simulated(
    folders: list[Path], seed: int, jobs: int, cover: Cover, watch: Watch[Any], what: str
) -> list[Example]:
    made = watch(examples_of(folders, seed, jobs, cover), what, len(folders))
    return [example for of_scan in made for example in of_scan]


def _labelled(trees: list[LabelledTree], rng: np.random.Generator) -> Lessons:
    """Labelled trees split by tree where there are enough, else by edge, with a warning."""
    notes = [HARD] + [
        f"{tree.name}: {tree.left_out} of {tree.labels} labels are of edges of another graph, and "
        "were left out"
        for tree in trees
        if tree.left_out
    ]
    trees = [tree for tree in trees if tree.graphs]
    if len(trees) >= FEWEST:
        by_name = {Path(str(k)): tree for k, tree in enumerate(trees)}
        parts = [[by_name[name] for name in own] for own in split_by_tree(list(by_name), rng)]
        sets = [[view for tree in own for graph in tree.graphs for view in graph] for own in parts]
        counts = [len(own) for own in parts]
    else:
        notes.append(
            f"{len(trees)} labelled trees: split by edge, since fewer than {FEWEST}. The figures "
            "flatter: edges of one tree are alike"
        )
        split = [split_by_edge(tree, SPLIT, rng) for tree in trees]
        sets = [[one for parts in split for one in parts[k]] for k in range(len(PARTS))]
        counts = [len(trees)] * len(PARTS)
    sets = [[one for one in own if one.told.any()] for own in sets]
    labels = [_labels(own) for own in sets]
    if min(labels) == 0:
        raise PrunusError(
            f"{sum(labels)} labelled edges; expected more, some to learn from, some to validate "
            "with and some to test on"
        )
    return Lessons(sets=sets, trees=counts, labels=labels, notes=notes)


def _labels(examples: list[Example]) -> int:
    """How many edges are labelled; the views of one graph share their category."""
    shared = {id(one.category): int(one.told.sum()) for one in examples}
    return sum(shared.values())
