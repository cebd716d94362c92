"""Examples to learn from: candidate edges of simulated scans as the network sees them.

Every scan gives some graphs, of all that it holds or of the target alone as a person would leave
it; the edges of each graph are seen again in another draw of the cloud, 20 000 to 100 000 points
(Appendix A). Scans are split by tree, never by edge.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from prunus.errors import PrunusError
from prunus.geometry.near import within
from prunus.lab.evaluate.seen import counting_rows
from prunus.lab.learn.edges.labels import UNTOLD, TrueWood, edge_labels
from prunus.lab.simulate.scan_folder import ScannedTree, read_scan
from prunus.model import Bools, CandidateGraph, Ints, Kind, PointCloud, Superpoints
from prunus.paper.candidates import find_candidates
from prunus.paper.images import description, edge_images
from prunus.paper.superpoints import find_superpoints
from prunus.params import Cover
from prunus.processes.workers import in_order

POINTS = (20_000, 100_000)
"""Clouds hold between so many points."""
GRAPHS = 2
"""Graphs from each scan; the edges of each are seen in two draws of the cloud."""
VIEWS: tuple[tuple[Kind, ...], ...] = (
    tuple(Kind),
    (Kind.TARGET, Kind.STRAY),
    (Kind.TARGET, Kind.WIRE, Kind.NEIGHBOUR, Kind.STRAY),
)
SHARES = (0.4, 0.4, 0.2)
"""What of a scan is in the cloud: all; the target alone; what a rough removal leaves."""

SPLIT = (0.7, 0.2, 0.1)
"""Shares of the trees to train on, to validate with, to test on."""


@dataclass(frozen=True, eq=False)
class Example:
    """The candidate edges of one cloud. images (E, 16, 32) count 0 to 255; category (E,).

    See `learn.labels` for the numbers of the categories.
    """

    images: NDArray[np.uint8]
    described: NDArray[np.float32]
    category: Ints

    @property
    def told(self) -> Bools:
        """Of which edges (E,) somebody said whether they are valid."""
        return np.asarray(self.category > UNTOLD)

    @property
    def valid(self) -> Bools:
        """Which edges (E,) are valid."""
        return np.asarray(self.category >= 0)


def split_by_tree(folders: list[Path], rng: np.random.Generator) -> list[list[Path]]:
    """The folders to train on, to validate with and to test on, drawn at random."""
    if len(folders) < 5:
        raise PrunusError(f"{len(folders)} simulated trees; expected at least 5 to split by tree")
    order = [folders[k] for k in rng.permutation(len(folders))]
    test = max(1, round(SPLIT[2] * len(order)))
    train = len(order) - test - max(1, round(SPLIT[1] * len(order)))
    return [sorted(order[:train]), sorted(order[train:-test]), sorted(order[-test:])]


def examples_of(folders: list[Path], seed: int, jobs: int, cover: Cover) -> Iterator[list[Example]]:
    """The examples of each scan, in order; superpoints as the network will meet them."""
    yield from in_order(partial(examples_in, seed=seed, cover=cover), folders, jobs)


def examples_in(folder: Path, seed: int, cover: Cover) -> list[Example]:
    """The examples of one scan: a function of the scan, the seed and how superpoints are chosen."""
    scan = read_scan(folder)
    rng = np.random.default_rng([seed, *os.fsencode(folder.name)])
    wood = true_wood(scan)
    return [one for _ in range(GRAPHS) for one in _examples(scan, wood, rng, cover)]


def true_wood(scan: ScannedTree) -> TrueWood:
    """All true trees of a scan, with what of them counts."""
    own = [scan.tree == number for number in range(len(scan.trees))]
    counts = [
        counting_rows(tree, scan.xyz[mine], scan.branch[mine])
        for tree, mine in zip(scan.trees, own, strict=True)
    ]
    return TrueWood.of(scan.trees, counts)


def _examples(
    scan: ScannedTree, wood: TrueWood, rng: np.random.Generator, cover: Cover
) -> Iterator[Example]:
    kinds = VIEWS[rng.choice(len(VIEWS), p=SHARES)]
    seen = scan.xyz[np.isin(scan.kind, kinds)]
    if len(seen) < 1000:
        return
    cloud = PointCloud.from_xyz(seen)
    graph = find_candidates(find_superpoints(drawn(cloud, rng), cover, rng))
    if len(graph.edges) < 10:
        return
    category = edge_labels(cloud.to_input.apply(graph.xyz), graph.edges, wood)
    yield example_of(graph, category)
    yield example_of(seen_again(graph, drawn(cloud, rng)), category)


def drawn(cloud: PointCloud, rng: np.random.Generator) -> PointCloud:
    """Points drawn at random, so many as clouds may hold."""
    low, high = (math.log(points) for points in POINTS)
    return cloud.sample(round(math.exp(rng.uniform(low, high))), rng)


def seen_again(graph: CandidateGraph, cloud: PointCloud) -> CandidateGraph:
    """The same edges in another draw of the same cloud."""
    under = graph.superpoints
    start, members = within(cloud.xyz, under.xyz, under.radius)
    seen = Superpoints(cloud, under.xyz, start, members, under.radius)
    return CandidateGraph(seen, graph.edges)


def example_of(graph: CandidateGraph, category: Ints) -> Example:
    """What the network sees of a graph."""
    images = np.rint(255 * edge_images(graph)).astype(np.uint8)
    return Example(images, description(graph), category)
