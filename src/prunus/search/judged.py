"""What score and network say of each edge of a skeleton, under the label it has and the others."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from prunus.model import Floats, Label, SeededGraph, Skeleton
from prunus.search.directed import Directed
from prunus.search.learned import LearnedScore, edge_terms


@dataclass(frozen=True, eq=False)
class Judged:
    """Of each edge (M,), by its lower row: what it brings under each label, and how likely that is.

    gain (M, L) without turns, see `edge_terms`; likely (M, L) by the network; zeros at row 0.
    """

    gain: Floats
    likely: Floats


def judged(skeleton: Skeleton, seeded: SeededGraph, score: LearnedScore) -> Judged:
    """What is known of the edges of a skeleton of candidate edges, found with categories."""
    ways = Directed.of(seeded)
    size = len(seeded.xyz)
    above, node = skeleton.superpoint[skeleton.edges].T
    d = np.searchsorted(ways.tail * size + ways.head, above * size + node)
    gain = np.einsum("dlt,lt->dl", edge_terms(seeded, ways)[d], score.edge)
    likely = seeded.scored.category[ways.edge[d]][:, : len(Label)]
    base = np.zeros((1, len(Label)))
    return Judged(np.concatenate([base, gain]), np.concatenate([base, likely]))
