"""Drawn trees as if the machine had found them, with spare superpoints behind; and random acts."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from prunus.editing import Act, AddPath, MoveBase, Reattach, Relabel, RemoveBranch, RemoveEdge
from prunus.editing.state import State
from prunus.model import (
    CandidateGraph,
    Label,
    PointCloud,
    ScoredGraph,
    SeededGraph,
    Skeleton,
    Superpoints,
)
from prunus.params import Parameters
from prunus.result import Result
from tests.drawn import TREE, tree

FAR = np.array([612_345.0, 5_123_456.0, 321.0])
"""The drawn trees stand here, so that a frame taken for another shows."""
BEHIND = 0.1
"""Behind each node of the tree is a spare superpoint, metres."""


@cache
def state(picture: str = TREE, seed: int = 0) -> State:
    """A drawn tree as the machine's, rows 0 to M - 1, and M spare superpoints behind them.

    All pairs within 15 cm are candidates, of any confidence and category.
    """
    rng = np.random.default_rng(seed)
    drawn = tree(picture)
    M = len(drawn)
    nodes = np.concatenate([drawn.xyz, drawn.xyz + np.array([0, BEHIND, 0])])
    cloud = PointCloud.from_xyz(nodes + FAR)
    away = np.linalg.norm(cloud.xyz[:, None] - cloud.xyz, axis=2)
    edges = np.argwhere(np.triu(away < 0.15, 1))
    own = Superpoints.of_nodes(cloud, 0.1)
    confidence = rng.uniform(0.3, 1, len(edges))
    category = rng.dirichlet(np.ones(5), len(edges))
    scored = ScoredGraph(
        candidates=CandidateGraph(own, edges),
        confidence=confidence,
        category=category,
        scorer="drawn",
    )
    graph = SeededGraph(scored, 0, np.array([M - 1]))
    found = Skeleton.build(cloud.xyz[:M], drawn.parent, drawn.label, superpoint=np.arange(M))
    return State.of(
        Result(
            in_house=found,
            graph=graph,
            score=0.0,
            history=np.zeros(1),
            seconds={},
            params=Parameters(),
            seed=0,
            warnings=[],
            notes=[],
            scan=cloud,
            isolated=None,
        )
    )


def node(at: State, x: float, z: float) -> int:
    """The node of the drawing at a column and a line above the base's."""
    base = at.draft.places[0]
    lowest = min(at.draft.places[:, 2])
    left = at.draft.places[:, 0].min()
    place = [left + x * 0.1, base[1], lowest + z * 0.1]
    return int(np.linalg.norm(at.draft.places - place, axis=1).argmin())


def spare(at: State, of: int) -> int:
    """The spare superpoint behind a node of the drawing."""
    return at.draft.superpoints // 2 + of


def outside(at: State, place: ArrayLike) -> tuple[float, float, float]:
    """A place of the house frame in the frame of the file."""
    x, y, z = at.scan.to_input.apply(place).tolist()
    return x, y, z


def random_act(at: State, rng: np.random.Generator) -> Act:
    """Any act on the skeleton, most often one that names nodes that are there."""
    draft = at.draft
    some = int(rng.choice(draft.nodes))
    any_node = int(rng.integers(len(draft.places) + 1))
    label = Label(int(rng.integers(4)))
    free = outside(at, draft.places[some] + rng.uniform(-0.2, 0.2, 3))
    beside = [n for n in range(len(draft.places)) if n not in draft]
    other = int(rng.choice(beside)) if beside else any_node
    place = free if rng.random() < 0.3 else other
    kind = int(rng.integers(8))
    if kind <= 2:
        return AddPath((some, place), label, bool(rng.random() < 0.7))
    if kind == 3:
        return RemoveEdge(some) if rng.random() < 0.5 else RemoveBranch(some)
    if kind <= 5:
        return Relabel(some, label, ("edge", "branch", "onward")[int(rng.integers(3))])
    if kind == 6:
        return Reattach(some, any_node if rng.random() < 0.2 else int(rng.choice(draft.nodes)))
    return MoveBase(free if rng.random() < 0.4 else any_node)
