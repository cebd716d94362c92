"""The edge network on the trees of the experiment: the paper's two tables (docs/learning.md)."""

from __future__ import annotations

from typing import Any

import numpy as np

from prunus.lab.experiment.orchard import Tree
from prunus.lab.learn.edges.labels import UNTOLD, TrueWood, edge_labels
from prunus.lab.learn.edges.tables import measures
from prunus.model import CandidateGraph, Ints
from prunus.paper.candidates import find_candidates
from prunus.paper.networks import NetworkScorer
from prunus.paper.superpoints import find_superpoints
from prunus.params import Parameters


def edge_record(tree: Tree) -> dict[str, Any]:
    """Confidence (E,), likeliest category (E,) and the truth (E,), -1 = not valid."""
    params, rng = Parameters.paper(), np.random.default_rng(0)
    cloud = tree.cloud.sample(params.input.count, rng)
    graph = find_candidates(find_superpoints(cloud, params.superpoints, rng))
    wood = TrueWood.of([tree.truth], [tree.counts])
    truth = edge_labels(cloud.to_input.apply(graph.xyz), graph.edges, wood)
    return judged_edges([(graph, truth)])


def judged_edges(graphs: list[tuple[CandidateGraph, Ints]]) -> dict[str, Any]:
    """What the network says of the edges of some graphs of which the truth (E,) is told."""
    found: dict[str, list[Any]] = {"confidence": [], "category": [], "truth": []}
    for graph, truth in graphs:
        told = truth > UNTOLD
        confidence, category = NetworkScorer().judge(graph)
        found["confidence"] += np.round(confidence[told], 4).tolist()
        found["category"] += category.argmax(axis=1)[told].tolist()
        found["truth"] += truth[told].tolist()
    return found


def edge_measures(records: list[dict[str, Any]]) -> dict[str, Any]:
    """The paper's tables of the network over all trees, see `learn.edges.tables`.

    Empty where no edge of any tree is known.
    """
    known = [record["edges"] for record in records if record["edges"]]
    if not known:
        return {}
    return measures(*(
        np.concatenate([np.array(edges[column]) for edges in known])
        for column in ("confidence", "category", "truth")
    ))  # fmt: skip
