"""Random small graphs to search, and the same for the slow twin."""

from __future__ import annotations

import numpy as np

from prunus.model import (
    CandidateGraph,
    Label,
    PointCloud,
    ScoredGraph,
    SeededGraph,
    Skeleton,
    Superpoints,
)
from prunus.paper.kernels.angles import grow_angle, turn_angle
from prunus.params import Parameters
from prunus.rules import offenders
from tests.reference import Edge, Orchard, Pairs


def random_graph(
    seed: int, nodes: int = 9, edges: int = 14, tips: int = 3, length: float = 0.4
) -> SeededGraph:
    """Nodes scattered in a plane, the shortest edges, any confidence, the highest nodes as tips.

    Node 0 is the base, the lowest.
    """
    rng = np.random.default_rng(seed)
    xyz = rng.uniform(-1, 1, (nodes, 3)) * [length, 0.05, length]
    xyz = xyz[np.argsort(xyz[:, 2])]
    cloud = PointCloud.from_xyz(xyz)
    pairs = np.array([(i, j) for i in range(nodes) for j in range(i + 1, nodes)])
    far = np.linalg.norm(xyz[pairs[:, 0]] - xyz[pairs[:, 1]], axis=1)
    pairs = pairs[np.sort(np.argsort(far)[:edges])]
    own = Superpoints.of_nodes(cloud, 0.1)
    scored = ScoredGraph.of_confidence(
        CandidateGraph(own, pairs), rng.uniform(0.2, 1, len(pairs)), "random"
    )
    return SeededGraph(scored, 0, np.arange(nodes - tips, nodes))


def orchard(graph: SeededGraph, params: Parameters) -> Orchard:
    """The graph for the slow twin; formulas written out once more."""
    xyz = graph.xyz
    conf: dict[Edge, float] = {}
    for (i, j), value in zip(graph.edges.tolist(), graph.confidence.tolist(), strict=True):
        conf[i, j] = conf[j, i] = value

    def vector(edge: Edge) -> np.ndarray:
        return np.asarray(xyz[edge[1]] - xyz[edge[0]])

    def length(edge: Edge) -> float:
        return float(np.linalg.norm(vector(edge)))

    def edge_score(edge: Edge) -> float:
        alpha = params.confidence.alpha_conf
        return length(edge) * (1 - (1 - conf[edge]) / (1 - alpha))

    def grow_penalty(edge: Edge, label: int) -> float:
        angle = float(grow_angle(vector(edge)))
        target = {Label.SUPPORT: angle, Label.LEADER: np.pi / 2 - angle}.get(Label(label), 0.0)
        return float(params.grow.c * max(target - params.grow.theta, 0) ** params.grow.p)

    def turn_penalty(after: Edge, before: Edge) -> float:
        angle = turn_angle(vector(after), vector(before))
        return float(params.turn.c * max(angle - params.turn.theta, 0) ** params.turn.p)

    def is_legal(pairs: Pairs) -> bool:
        return not pairs or offenders(as_skeleton(graph, pairs)) == {}

    return Orchard(
        graph.base,
        frozenset(conf),
        edge_score,
        grow_penalty,
        turn_penalty,
        lambda edge: length(edge) * (1 - conf[edge]),
        is_legal,
    )


def as_skeleton(graph: SeededGraph, pairs: Pairs) -> Skeleton:
    """A set of (edge, label) pairs as a skeleton."""
    nodes, parent, label = [graph.base], [-1], [0]
    for row, node in enumerate(nodes):
        for (tail, head), word in sorted(pairs):
            if tail == node:
                nodes.append(head)
                parent.append(row)
                label.append(word)
    assert len(nodes) == len(pairs) + 1
    return Skeleton.build(graph.xyz[nodes], parent, label, superpoint=nodes)


def as_pairs(skeleton: Skeleton) -> Pairs:
    """A skeleton as a set of (edge, label) pairs."""
    nodes = skeleton.superpoint.tolist()
    return frozenset(
        ((nodes[int(skeleton.parent[row])], nodes[row]), int(skeleton.label[row]))
        for row in range(1, len(skeleton))
    )
