"""Locating side branches: what leaves the leaders sideways (sec. Locating side branches)."""

from __future__ import annotations

from dataclasses import dataclass
from heapq import heappop, heappush

import numpy as np

from prunus.geometry.pieces import components
from prunus.grammar import SIDE_BRANCH_PARENTS
from prunus.model import Floats, Ints, Label, SeededGraph, Skeleton
from prunus.paper.kernels.angles import turn_angle
from prunus.params import Parameters

Edge = tuple[int, int]


@dataclass(frozen=True, eq=False, kw_only=True)
class _FreeGraph:
    """Confident edges of superpoints outside the skeleton, and what joins them to it."""

    xyz: Floats
    confidence: dict[Edge, float]
    neighbours: dict[int, list[int]]
    params: Parameters

    def vector(self, edge: Edge) -> Floats:
        """From the first superpoint to the second."""
        return np.asarray(self.xyz[edge[1]] - self.xyz[edge[0]])

    def length(self, edge: Edge) -> float:
        """Len, metres."""
        return float(np.linalg.norm(self.vector(edge)))

    def cost(self, edge: Edge, before: Edge | None) -> float | None:
        """Cost of an edge after another (eq. Cost); None where the turn is too sharp."""
        cost = self.length(edge) * (1 - self.confidence[edge])
        if before is None:
            return cost
        angle = float(turn_angle(self.vector(edge), self.vector(before)))
        if angle > self.params.side_branches.turn_max:
            return None
        turn = self.params.turn
        return cost + float(turn.c * max(angle - turn.theta, 0.0) ** turn.p)


def find_side_branches(skeleton: Skeleton, seeded: SeededGraph, params: Parameters) -> Skeleton:
    """The skeleton with the side branches of its leaders, from the loose pieces that touch them.

    A piece that also touches trunk or support is not a side branch, and one that does not gives
    one.
    """
    row_of = {int(node): row for row, node in enumerate(skeleton.superpoint)}
    graph, piece = _free_graph(seeded, set(row_of), params)
    starts: dict[int, list[Edge]] = {}
    rejected = set()
    for edge in graph.confidence:
        if edge[0] not in row_of or edge[1] in row_of:
            continue
        row, group = row_of[edge[0]], int(piece[edge[1]])
        if row == 0 or skeleton.label[row] not in SIDE_BRANCH_PARENTS:
            rejected.add(group)
        elif _is_sideways(graph.vector(edge), skeleton, row, params):
            starts.setdefault(group, []).append(edge)
    kept = [starts[group] for group in sorted(starts) if group not in rejected]
    paths = [_longest_cheapest(graph, edges) for edges in kept]
    return _with_paths(skeleton, row_of, paths, graph)


def _free_graph(
    seeded: SeededGraph, taken: set[int], params: Parameters
) -> tuple[_FreeGraph, Ints]:
    sure = np.flatnonzero(seeded.confidence >= params.confidence.alpha_conf)
    inside = np.isin(seeded.edges[sure], list(taken))
    piece = components(len(seeded.xyz), seeded.edges[sure[~inside.any(axis=1)]])
    confidence: dict[Edge, float] = {}
    neighbours: dict[int, list[int]] = {}
    for e in sure[~inside.all(axis=1)]:
        i, j = (int(node) for node in seeded.edges[e])
        for a, b in ((i, j), (j, i)):
            confidence[a, b] = float(seeded.confidence[e])
            if b not in taken:
                neighbours.setdefault(a, []).append(b)
    return _FreeGraph(
        xyz=seeded.xyz, confidence=confidence, neighbours=neighbours, params=params
    ), piece


def _is_sideways(vector: Floats, skeleton: Skeleton, row: int, params: Parameters) -> bool:
    """Whether an edge leaves the leader at this row between the two angles."""
    onward = np.flatnonzero((skeleton.parent == row) & (skeleton.label == skeleton.label[row]))
    end = skeleton.xyz[onward[0]] if len(onward) else skeleton.xyz[row]
    angle = turn_angle(vector, end - skeleton.xyz[skeleton.parent[row]])
    return bool(params.side_branches.angle_min <= angle <= params.side_branches.angle_max)


def _longest_cheapest(graph: _FreeGraph, starts: list[Edge]) -> list[Edge]:
    """Of the cheapest paths to each free superpoint of a piece, the one that reaches farthest."""
    best: dict[int, tuple[float, list[Edge]]] = {}
    heap: list[tuple[float, Edge, list[Edge]]] = []
    settled = set()
    for edge in starts:
        cost = graph.cost(edge, None)
        assert cost is not None
        heappush(heap, (cost, edge, [edge]))
    while heap:
        total, edge, path = heappop(heap)
        if edge in settled:
            continue
        settled.add(edge)
        best.setdefault(edge[1], (total, path))
        visited = {node for step in path for node in step}
        for node in graph.neighbours.get(edge[1], []):
            step = graph.cost((edge[1], node), edge)
            if node not in visited and (edge[1], node) not in settled and step is not None:
                heappush(heap, (total + step, (edge[1], node), [*path, (edge[1], node)]))
    return max(
        (path for _, path in best.values()),
        key=lambda path: sum(graph.length(edge) for edge in path),
    )


def _with_paths(
    skeleton: Skeleton, row_of: dict[int, int], paths: list[list[Edge]], graph: _FreeGraph
) -> Skeleton:
    nodes, parent, confidence = [], [], []
    for path in paths:
        above = row_of[path[0][0]]
        for edge in path:
            parent.append(above)
            nodes.append(edge[1])
            confidence.append(graph.confidence[edge])
            above = len(skeleton) + len(nodes) - 1
    added = np.array(nodes, np.int64)
    return Skeleton.build(
        np.concatenate([skeleton.xyz, graph.xyz[added]]),
        np.concatenate([skeleton.parent, np.array(parent, np.int64)]),
        np.concatenate([skeleton.label, np.full(len(nodes), int(Label.SIDE_BRANCH))]),
        confidence=np.concatenate([skeleton.confidence, confidence]),
        radius=np.concatenate([skeleton.radius, np.full(len(nodes), np.nan)]),
        superpoint=np.concatenate([skeleton.superpoint, added]),
    )
