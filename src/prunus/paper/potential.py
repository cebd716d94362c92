"""Path priors: how well each edge leads to each tip (sec. Determining eligible pairs)."""

from __future__ import annotations

import numpy as np

from prunus.errors import PrunusError
from prunus.model import Floats, Ints
from prunus.paper.kernels.paths import tip_paths
from prunus.paper.kernels.tables import GraphTable, PriorTable

MOST_BYTES = 4 * 2**30
"""A table of ways larger than this is none that a machine should be asked for."""


def path_priors(
    graph: GraphTable, score: Floats, cost: Floats, base: int, tips: Ints
) -> PriorTable:
    """One Dijkstra a tip over the directed edges (eq. Cost); see `kernels.paths.tip_paths`.

    Raises PrunusError where the ways of all tips would not fit into memory.
    """
    D, T = len(graph.tail), len(tips)
    words = (len(graph.out_start) - 1 + 63) // 64
    size = T * D * 8 * (words + 3)
    if size > MOST_BYTES:
        raise PrunusError(
            f"the ways to {T} tips over {D // 2} edges take {size / 2**30:.0f} GB; expected at "
            f"most {MOST_BYTES / 2**30:.0f} GB: fewer tips or edges (one tree alone)"
        )
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
