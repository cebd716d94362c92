"""The graph of the threads: which nodes may be joined, and what it costs to grow over an edge.

Nodes close together are joined; loose pieces are bridged over gaps. To grow over an edge costs its
length, more where the way does not go as the network says that wood runs there, and much more
where it crosses a gap.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import csr_array
from scipy.spatial import cKDTree

from prunus.field.votes import Threads
from prunus.geometry.pieces import components, matrix_of
from prunus.model import Bools, Floats, Ints, Role

NEAR_M = 0.04
"""Nodes so close are joined."""
GAPS_M = (0.30, 0.50)
"""Gaps up to the first are bridged; up to the second those of pieces that hang loose then."""
BRIDGES = 12
"""So many bridges at most between two pieces, the cheapest."""
ASTRAY = 8.0
"""What a metre costs more for each unit by which its direction is off (one less the cosine)."""
ASTRAY_IN_GAP = 8.0
"""The same across a gap, where nothing else is seen."""
WANDERS = 0.15
"""A direction that is off by so little goes with the flow."""
GAP, GAP_SQUARED = 4.0, 6.0
"""What a metre of a gap costs more, and a square metre."""
NEARER, ELSEWHERE, LOOSE = 0.05, 4.0, 8.0
"""Of which tree wood is: what a metre from its foot costs, what more for each unit by which the
direction is off by more than `ASTRAY_LEAST`, and what a metre of a gap. It hardly counts how near a
foot is: trees stand as near to each other as their branches are long."""
ASTRAY_LEAST = 0.2


@dataclass(frozen=True, eq=False, kw_only=True)
class ThreadGraph:
    """The threads (N nodes) and edges (E, 2) between them, i < j; `gap` (E,): a bridge."""

    threads: Threads
    edges: Ints
    gap: Bools

    @cached_property
    def outward(self) -> Ints:
        """Both directions of each edge (2 E, 2), from nearer the foot to farther."""
        return np.concatenate([self.edges, self.edges[:, ::-1]])

    @cached_property
    def costs(self) -> Floats:
        """What it costs to grow over each of `outward` (2 E,)."""
        return growth_costs(self.threads, self.outward, np.tile(self.gap, 2))

    @cached_property
    def belonging(self) -> csr_array:
        """What it costs (N, N) to take the wood at the column for that of the row's tree."""
        size = len(self.threads)
        length, off = _off(self.threads, self.outward)
        gap = np.where(np.tile(self.gap, 2), LOOSE * length + GAP_SQUARED * length**2, 0.0)
        off = np.maximum(off - ASTRAY_LEAST, 0.0)
        return matrix_of(self.outward, length * (NEARER + ELSEWHERE * off) + gap, size)

    def within(self, tree: Ints) -> csr_array:
        """The costs of growing (N, N) over edges that stay in one tree (N,)."""
        own = tree[self.outward[:, 0]] == tree[self.outward[:, 1]]
        return matrix_of(self.outward[own], self.costs[own], len(self.threads))

    @cached_property
    def against(self) -> csr_array:
        """How far (N, N) each of `outward` goes against the flow of wood, metres; none is 1e-9."""
        length, off = _off(self.threads, self.outward)
        metres = length * np.maximum(off - WANDERS, 0.0) / 2 + 1e-9
        return matrix_of(self.outward, metres, len(self.threads))


def _off(threads: Threads, outward: Ints) -> tuple[Floats, Floats]:
    """The length (E,) of each edge, and how far off its direction is, 0 to 2."""
    way = threads.xyz[outward[:, 1]] - threads.xyz[outward[:, 0]]
    length = np.maximum(np.linalg.norm(way, axis=1), 1e-9)
    off = 1 + (way * threads.toward_foot[outward[:, 1]]).sum(axis=1) / length
    return length, off


def growth_costs(threads: Threads, outward: Ints, gap: Bools) -> Floats:
    """What it costs (E,) to grow over edges (E, 2) from their first node to their second."""
    length, off = _off(threads, outward)
    along = length * (1 + np.where(gap, ASTRAY_IN_GAP, ASTRAY) * off)
    across = np.where(gap, GAP * length + GAP_SQUARED * length**2, 0.0)
    return np.asarray(along + across)


def confidence_of(threads: Threads, outward: Ints) -> Floats:
    """How sure wood goes (E,) over edges (E, 2): by its being wood, and its length for its cost."""
    length = np.linalg.norm(threads.xyz[outward[:, 1]] - threads.xyz[outward[:, 0]], axis=1)
    cost = growth_costs(threads, outward, length > NEAR_M)
    wood = 1 - threads.role[outward, Role.NO_WOOD].max(axis=1)
    return np.asarray(wood * np.clip(length / np.maximum(cost, 1e-9), 0.0, 1.0))


def join_threads(threads: Threads, gap_max: float = GAPS_M[-1]) -> ThreadGraph:
    """The graph of some threads, over gaps of `gap_max` metres at most."""
    near = threads.tree.query_pairs(NEAR_M, output_type="ndarray").astype(np.int64)
    edges = near
    for reach in np.minimum(GAPS_M, gap_max).tolist():
        edges = np.concatenate([edges, _bridges(threads, edges, reach)])
    gap = np.arange(len(edges)) >= len(near)
    order = np.lexsort(edges.T[::-1])
    return ThreadGraph(threads=threads, edges=edges[order], gap=gap[order])


def _bridges(threads: Threads, edges: Ints, reach: float) -> Ints:
    """The cheapest bridges (B, 2) between pieces that lie within reach of each other."""
    piece = components(len(threads), edges)
    loose = piece != np.bincount(piece).argmax()  # from the largest it is the way back
    some = np.flatnonzero(loose)
    if len(some) == 0:
        return np.zeros((0, 2), np.int64)
    found = cKDTree(threads.xyz[some]).sparse_distance_matrix(
        threads.tree, reach, output_type="ndarray"
    )
    pairs = np.column_stack([some[found["i"]], found["j"]])
    once = ~loose[pairs[:, 1]] | (pairs[:, 0] < pairs[:, 1])
    pairs = pairs[once & (piece[pairs[:, 0]] != piece[pairs[:, 1]])]
    yes = np.ones(len(pairs), np.bool_)
    there, back = (growth_costs(threads, way, yes) for way in (pairs, pairs[:, ::-1]))
    ends = np.sort(piece[pairs], axis=1) @ np.array([len(threads), 1])
    kept = [_cheapest(ends, cost) for cost in (there, back)]
    return np.sort(pairs[np.unique(np.concatenate(kept))], axis=1)


def _cheapest(ends: Ints, cost: Floats) -> Ints:
    """The rows of the cheapest pairs of each two pieces, which `ends` (B,) number."""
    order = np.lexsort((cost, ends))
    first = np.append(True, np.diff(ends[order]) != 0)
    start = np.flatnonzero(first)
    rank = np.arange(len(order)) - np.repeat(start, np.diff(np.append(start, len(order))))
    return np.asarray(order[rank < BRIDGES])
