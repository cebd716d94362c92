"""What a search returns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from prunus.model import Floats, SeededGraph, Skeleton, parents_first
from prunus.paper.kernels.tables import LABELS, GraphTable

Entries = NDArray[np.int32]
"""A skeleton as a row of entries (N,), see `paper/kernels/tables.py`."""


@dataclass(frozen=True, eq=False)
class SearchResult:
    """The skeleton, its score, and the best score (I,) in each iteration of the search."""

    skeleton: Skeleton
    score: float
    history: Floats


def as_skeleton(entry: Entries, graph: GraphTable, seeded: SeededGraph) -> Skeleton:
    """The skeleton of a row of entries, parents before children."""
    grown = np.flatnonzero(entry >= 0)
    tails = graph.tail[entry[grown] // LABELS].tolist()
    nodes, parent = parents_first(seeded.base, dict(zip(grown.tolist(), tails, strict=True)))
    label = (entry[nodes] % LABELS).tolist()
    label[0] = label[1] if len(label) > 1 else 0
    return Skeleton.build(
        seeded.xyz[nodes],
        parent,
        label,
        confidence=_confidence(nodes, parent, seeded),
        superpoint=nodes,
    )


def _confidence(nodes: list[int], parent: list[int], seeded: SeededGraph) -> Floats:
    of_pair = {
        (int(i), int(j)): c for (i, j), c in zip(seeded.edges, seeded.confidence, strict=True)
    }
    ends = [(nodes[p], nodes[row]) for row, p in enumerate(parent)]
    known = [of_pair[min(pair), max(pair)] for pair in ends[1:]]
    return np.array([np.nan, *known])
