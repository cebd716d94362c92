"""Examples from scans of which a person labelled some edges (`io.labels`).

The chain is run again up to the candidate graph, as the studio did. Only labelled edges count in
the loss; the others are what the network sees around them. As the paper did with its 700 edges,
each graph is seen again in other draws of the cloud.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from prunus.errors import PrunusError
from prunus.files.work_folder import MASK
from prunus.frames.scan import open_scan
from prunus.io.clouds.classes import target_of
from prunus.io.labels import CATEGORIES, EdgeLabel, LabelHead, Labels, read_labels
from prunus.io.original import original_of
from prunus.lab.learn.edges.examples import Example, drawn, example_of, seen_again
from prunus.lab.learn.edges.labels import INVALID, SOME, UNTOLD
from prunus.model import CandidateGraph, Ints, PointCloud
from prunus.names import as_text
from prunus.paper.candidates import find_candidates
from prunus.params import Parameters
from prunus.pipeline import skeletonize
from prunus.processes.workers import in_order

VIEWS = 4
"""Each graph is seen in so many draws of its cloud, the first that of the studio."""
SAME_PLACE = 1e-3
"""A superpoint is the one that was labelled when it is within so many metres of where that was."""


@dataclass(frozen=True, eq=False, kw_only=True)
class LabelledTree:
    """Of one tree the views of each of its graphs; how many labels it has, how many lie on none.

    All views of a graph have the same edges.
    """

    name: str
    graphs: list[list[Example]]
    labels: int
    left_out: int


@dataclass(frozen=True, eq=False)
class MadeGraph:
    """A candidate graph, and the cloud (all points of the tree) that it was made from."""

    cloud: PointCloud
    candidates: CandidateGraph


def labelled_trees(
    paths: list[Path], seed: int, jobs: int, scans: Path | None = None
) -> Iterator[LabelledTree]:
    """The labelled trees of some `labels.jsonl`, in order."""
    yield from in_order(partial(labelled_tree, seed=seed, scans=scans), paths, jobs)


def labelled_tree(path: Path, seed: int, scans: Path | None = None) -> LabelledTree:
    """The examples of one `labels.jsonl`.

    Raises PrunusError where its scan is not found, or none of its labels lies on an edge of the
    graph that the chain makes of it.
    """
    held = read_labels(path)
    rng = np.random.default_rng([seed, *os.fsencode(path.parent.name)])
    found, over = labelled_graphs(held, scans)
    graphs = [list(_views(graph, category, rng)) for graph, category in found]
    return LabelledTree(
        name=as_text(path.parent.name), graphs=graphs, labels=len(held.labels), left_out=len(over)
    )


def labelled_graphs(
    held: Labels, scans: Path | None = None
) -> tuple[list[tuple[MadeGraph, Ints]], list[EdgeLabel]]:
    """The graphs on which labels lie, with the category (E,) of their edges; labels left over.

    Raises PrunusError where the scan is not found, or no label lies on an edge.
    """
    path, over, graphs = held.path, held.labels, list[tuple[MadeGraph, Ints]]()
    if not over:
        return graphs, over
    source = original_of(held.head.input, path.parent, scans)
    for graph in _graphs(source, held.head, path.parent / MASK):
        if not over:
            break
        category, over = matched(over, graph)
        if (category > UNTOLD).any():
            graphs.append((graph, category))
    if not graphs:
        raise PrunusError(
            f"{path}: none of its {len(held.labels)} labels is on an edge of the candidate graph "
            f"of {source}; expected the version of prunus that it was made with, "
            f"{held.head.version_of_prunus}"
        )
    return graphs, over


def matched(labels: list[EdgeLabel], graph: MadeGraph) -> tuple[Ints, list[EdgeLabel]]:
    """The category (E,) of each candidate edge, `UNTOLD` where no label is; the labels left over.

    A label is of the edge between superpoints of its numbers, where those lie where it says.
    """
    candidates = graph.candidates
    nodes = graph.cloud.to_input.apply(candidates.xyz)
    row = {tuple(edge): k for k, edge in enumerate(candidates.edges.tolist())}
    category = np.full(len(candidates.edges), UNTOLD)
    over = []
    for label in labels:
        k = row.get(label.edge)
        if k is None or np.abs(nodes[list(label.edge)] - label.xyz).max() > SAME_PLACE:
            over.append(label)
        else:
            category[k] = category_of(label)
    return category, over


def category_of(label: EdgeLabel) -> int:
    """What was said of an edge, as a number (see `learn.labels`)."""
    if not label.valid:
        return INVALID
    return SOME if label.category is None else CATEGORIES.index(label.category)


def split_by_edge(
    tree: LabelledTree, shares: tuple[float, ...], rng: np.random.Generator
) -> list[list[Example]]:
    """The examples of a tree, once for each share of its edges; all views are split alike."""
    found: list[list[Example]] = [[] for _ in shares]
    for views in tree.graphs:
        category = views[0].category
        part = np.searchsorted(np.cumsum(shares)[:-1], rng.random(len(category)), side="right")
        for number, into in enumerate(found):
            own = np.where(part == number, category, UNTOLD)
            into += [replace(view, category=own) for view in views]
    return found


def _views(graph: MadeGraph, category: Ints, rng: np.random.Generator) -> Iterator[Example]:
    yield example_of(graph.candidates, category)
    for _ in range(VIEWS - 1):
        yield example_of(seen_again(graph.candidates, drawn(graph.cloud, rng)), category)


def _graphs(source: Path, head: LabelHead, mask: Path) -> Iterator[MadeGraph]:
    """The candidate graph as the chain makes it, and that of the points marked as the target."""
    scan = open_scan(source, head.frame, head.unit)
    params = Parameters.parse(head.params, str(source))
    yield _graph(scan.cloud, head, params)
    if mask.exists():
        target = target_of(mask, len(scan.cloud))
        yield _graph(scan.cloud.take(target), head, params.changed("isolation", isolate="never"))


def _graph(cloud: PointCloud, head: LabelHead, params: Parameters) -> MadeGraph:
    result = skeletonize(cloud, head.base, params, head.seed)
    own = cloud if result.isolated is None else cloud.take(result.isolated.target)
    return MadeGraph(own, find_candidates(result.graph.superpoints))
