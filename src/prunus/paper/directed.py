"""Every candidate edge in both directions, sorted by where it starts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from prunus.model import Floats, Ints, SeededGraph


@dataclass(frozen=True, eq=False, kw_only=True)
class Directed:
    """Directed edges d, D = 2 E of them, sorted by tail, then head.

    tail, head (D,); out_start (N + 1,); `edge` (D,) the candidate edge of each; vector (D, 3);
    length (D,); `pair_start` (D + 1,): the pairs (d, d') in which d' leaves where d ends.
    """

    tail: Ints
    head: Ints
    out_start: Ints
    edge: Ints
    vector: Floats
    length: Floats
    pair_start: Ints

    @classmethod
    def of(cls, seeded: SeededGraph) -> Directed:
        """The directed edges of a graph."""
        both = np.concatenate([seeded.edges, seeded.edges[:, ::-1]])
        order = np.lexsort([both[:, 1], both[:, 0]])
        tail, head = both[order].T
        out_start = np.searchsorted(tail, np.arange(len(seeded.xyz) + 1))
        vector = seeded.xyz[head] - seeded.xyz[tail]
        return cls(
            tail=tail,
            head=head,
            out_start=out_start,
            edge=order % max(len(seeded.edges), 1),
            vector=vector,
            length=np.linalg.norm(vector, axis=1),
            pair_start=np.concatenate([[0], np.cumsum(np.diff(out_start)[head])]),
        )

    @property
    def pair_of(self) -> Ints:
        """Where the pairs of each edge stand (D,): d followed by d' is pair `pair_of[d] + d'`."""
        return np.asarray(self.pair_start[:-1] - self.out_start[self.head])

    def pairs(self) -> tuple[Ints, Ints]:
        """The first and the second edge of every pair."""
        count = np.diff(self.pair_start)
        first = np.repeat(np.arange(len(self.tail)), count)
        second = np.arange(len(first)) - np.repeat(self.pair_of, count)
        return first, second
