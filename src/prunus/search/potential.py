"""Path priors: how well each edge leads to each tip (sec. Determining eligible pairs)."""

from __future__ import annotations

import numpy as np

from prunus.kernels.paths import tip_paths
from prunus.kernels.tables import GraphTable, PriorTable
from prunus.model import Floats, Ints


def path_priors(
    graph: GraphTable, score: Floats, cost: Floats, base: int, tips: Ints
) -> PriorTable:
    """One Dijkstra a tip over the directed edges (eq. Cost); see `kernels.paths.tip_paths`."""
    D, T = len(graph.tail), len(tips)
    words = (len(graph.out_start) - 1 + 63) // 64
    priors = PriorTable(
        np.full((T, D, words), ~np.uint64(0)),
        np.zeros((T, D)),
        np.zeros((T, D)),
        np.zeros((T, D)),
    )
    into = np.lexsort([graph.tail, graph.head])
    into_start = np.searchsorted(graph.head[into], np.arange(len(graph.out_start)))
    for row, tip in enumerate(tips):
        tip_paths(
            int(tip),
            base,
            graph.tail,
            graph.head,
            into_start,
            into,
            cost,
            score,
            graph.turn[0],
            graph.pair_of,
            priors.on_path[row],
            priors.after[row],
            priors.first[row],
            priors.second[row],
        )
    return priors
