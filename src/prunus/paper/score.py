"""The objective: SkelScore and its parts (sec. Skeleton evaluation objective function)."""

from __future__ import annotations

import numpy as np

from prunus.grammar import GROWTH_TARGET, SEARCHED
from prunus.model import Floats, Label, SeededGraph, Skeleton
from prunus.paper.directed import Directed
from prunus.paper.kernels.angles import grow_angle, turn_penalties
from prunus.paper.kernels.tables import GraphTable
from prunus.params import Grow, Parameters, Turn

EXACT = 2.0**32
"""Rewards are rounded to 1 / EXACT, so that a sum does not depend on the order of its terms."""


def edge_score(length: Floats, confidence: Floats, alpha_conf: float) -> Floats:
    """EdgeScore (E,) = Len (1 - (1 - Conf) / (1 - alpha_conf)) (eq. edgescore)."""
    return np.asarray(length * (1 - (1 - confidence) / (1 - alpha_conf)))


def grow_penalty(vectors: Floats, label: Label, params: Grow) -> Floats:
    """GrowPenalty (E,) of edges (E, 3) under one label (eqs. growpenalty, DeltaTarget)."""
    if label not in GROWTH_TARGET:
        return np.zeros(len(vectors))
    off = np.abs(GROWTH_TARGET[label] - grow_angle(vectors))
    return np.asarray(params.c * np.maximum(off - params.theta, 0) ** params.p)


def turn_penalty(before: Floats, after: Floats, params: Turn) -> Floats:
    """TurnPenalty (E,) of edges (E, 3) after predecessors of the same label (eq. turnpenalty)."""
    sizes = np.linalg.norm(before, axis=1) * np.linalg.norm(after, axis=1)
    angle = np.arccos(np.clip((before * after).sum(axis=1) / sizes, -1, 1))
    return np.asarray(params.c * np.maximum(angle - params.theta, 0) ** params.p)


def skel_score(skeleton: Skeleton, params: Parameters) -> float:
    """SkelScore: the sum of the rewards of trunk, support and leader edges (eq. skelscore)."""
    rows = np.flatnonzero(np.isin(skeleton.label, SEARCHED) & (skeleton.parent >= 0))
    vectors = skeleton.edge_vectors
    total = edge_score(
        skeleton.lengths[rows], skeleton.confidence[rows], params.confidence.alpha_conf
    ).sum()
    for label in SEARCHED:
        grown = rows[skeleton.label[rows] == label]
        total -= grow_penalty(vectors[grown], label, params.grow).sum()
    parent = skeleton.parent[rows]
    same = rows[(parent > 0) & (skeleton.label[parent] == skeleton.label[rows])]
    total -= turn_penalty(vectors[skeleton.parent[same]], vectors[same], params.turn).sum()
    return float(total)


def graph_table(
    seeded: SeededGraph, params: Parameters, rng: np.random.Generator
) -> tuple[GraphTable, Floats, Floats]:
    """The directed edges with their rewards; EdgeScore (D,) and Len (1 - Conf) (D,) beside it."""
    ways = Directed.of(seeded)
    confidence = seeded.confidence[ways.edge]
    score = exact(edge_score(ways.length, confidence, params.confidence.alpha_conf))
    penalty = [grow_penalty(ways.vector, label, params.grow) for label in SEARCHED]
    turn = turn_penalties(
        ways.vector, ways.head, ways.out_start, ways.pair_start,
        params.turn.theta, params.turn.c, params.turn.p,
    )  # fmt: skip
    table = GraphTable(
        ways.tail,
        ways.head,
        ways.out_start,
        exact(score[:, None] - np.stack(penalty, axis=1)),
        turn[None],
        ways.pair_of,
        np.where(np.eye(len(SEARCHED), dtype=np.bool_), 0, -1),
        rng.integers(0, 2**64, (len(ways.tail), len(SEARCHED)), np.uint64),
    )
    return table, score, ways.length * (1 - confidence)


def exact(values: Floats) -> Floats:
    """Values rounded to 1 / EXACT."""
    return np.asarray(np.rint(values * EXACT) / EXACT)
