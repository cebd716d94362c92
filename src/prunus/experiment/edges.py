"""The edge networks on the trees of the experiment: the paper's two tables (docs/learning.md)."""

from __future__ import annotations

from typing import Any

import numpy as np

from prunus.experiment.orchard import Tree
from prunus.learn.labels import UNTOLD, TrueWood, edge_labels
from prunus.learn.tables import measures
from prunus.model import CandidateGraph, Ints
from prunus.params import Parameters
from prunus.stages.candidates import find_candidates
from prunus.stages.networks import NetworkScorer
from prunus.stages.superpoints import find_superpoints

NETWORKS = {"paper": Parameters.paper(), "ours": Parameters.learned()}
"""Each network on the candidate edges of the way that it serves."""


def edge_record(tree: Tree) -> dict[str, Any]:
    """By network: confidence (E,), likeliest category (E,) and the truth (E,), -1 = not valid."""
    wood = TrueWood.of([tree.truth], [tree.counts])
    found = {}
    for name, params in NETWORKS.items():
        rng = np.random.default_rng(0)
        cloud = tree.cloud.sample(50_000, rng)
        graph = find_candidates(find_superpoints(cloud, params.superpoints, rng))
        truth = edge_labels(cloud.to_input.apply(graph.xyz), graph.edges, wood)
        found[name] = judged_edges(name, [(graph, truth)])
    return found


def judged_edges(network: str, graphs: list[tuple[CandidateGraph, Ints]]) -> dict[str, Any]:
    """What a network says of the edges of some graphs of which the truth (E,) is told."""
    found: dict[str, list[Any]] = {"confidence": [], "category": [], "truth": []}
    for graph, truth in graphs:
        told = truth > UNTOLD
        confidence, category = NetworkScorer.shipped(network).judge(graph)
        found["confidence"] += np.round(confidence[told], 4).tolist()
        found["category"] += category.argmax(axis=1)[told].tolist()
        found["truth"] += truth[told].tolist()
    return found


def edge_measures(records: list[dict[str, Any]]) -> dict[str, Any]:
    """The paper's tables of each network over all trees, see `learn.tables.measures`.

    Empty where no edge of any tree is known.
    """
    records = [record for record in records if record["edges"]]
    if not records:
        return {}
    return {
        name: measures(*(
            np.concatenate([np.array(record["edges"][name][column]) for record in records])
            for column in ("confidence", "category", "truth")
        ))
        for name in NETWORKS
    }  # fmt: skip
