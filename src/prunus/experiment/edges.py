"""The edge networks on the trees of the experiment: the paper's two tables (measures.md C)."""

from __future__ import annotations

from typing import Any

import numpy as np

from prunus.experiment.orchard import tree_of
from prunus.learn.labels import TrueWood, edge_labels
from prunus.learn.tables import measures
from prunus.params import Parameters
from prunus.simulate.settings import Setting
from prunus.stages.candidates import find_candidates
from prunus.stages.networks import NetworkScorer
from prunus.stages.superpoints import find_superpoints

NETWORKS = {"paper": Parameters.paper(), "ours": Parameters()}
"""Each network on the candidate edges of the way that it serves."""


def edge_record(seed: int, setting: Setting) -> dict[str, Any]:
    """By network: confidence (E,), likeliest category (E,) and the truth (E,), -1 = not valid."""
    tree = tree_of(seed, setting)
    wood = TrueWood.of([tree.truth], [tree.counts])
    found = {}
    for name, params in NETWORKS.items():
        rng = np.random.default_rng(0)
        cloud = tree.cloud.sample(50_000, rng)
        graph = find_candidates(find_superpoints(cloud, params.superpoints, rng))
        confidence, category = NetworkScorer.shipped(name).judge(graph)
        truth = edge_labels(cloud.to_input.apply(graph.xyz), graph.edges, wood)
        found[name] = {
            "confidence": np.round(confidence, 4).tolist(),
            "category": category.argmax(axis=1).tolist(),
            "truth": truth.tolist(),
        }
    return found


def edge_measures(records: list[dict[str, Any]]) -> dict[str, Any]:
    """The paper's tables of each network over all trees, see `learn.tables.measures`."""
    return {
        name: measures(*(
            np.concatenate([np.array(record["edges"][name][column]) for record in records])
            for column in ("confidence", "category", "truth")
        ))
        for name in NETWORKS
    }  # fmt: skip
