"""Beyond the paper: a skeleton improved by hanging a node, or two, elsewhere."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from prunus.kernels.refine import NEVER, OUTSIDE, ROOT, climb, complete
from prunus.kernels.tables import ABSENT, BASE, LABELS, GrammarTable, GraphTable
from prunus.model import Bools, Floats, Ints

SWEEPS = 50
"""More than any tree has needed; a bound, not a setting."""

Entries = NDArray[np.int32]
"""A skeleton as a row of entries (N,), see `kernels/tables.py`."""


def refine(
    entry: Entries, graph: GraphTable, grammar: GrammarTable, cost: Floats, may_end: Bools
) -> tuple[Entries, Floats]:
    """The skeleton (N,) that no move improves, and the score before and after each sweep (I,).

    `may_end` (N,) says at which nodes a branch may end; the base is always one. Where it holds all
    ends of the skeleton given, the one returned is at least as good. `cost` (D,): Len (1 - Conf).
    """
    into = np.where(entry >= 0, entry // LABELS, OUTSIDE)
    into[entry == BASE] = ROOT
    order = complete(into, graph, cost)
    worth, history = climb(into, order, may_end, graph, grammar, SWEEPS)
    chosen = np.full_like(entry, ABSENT)
    base = int(order[0])
    chosen[base] = BASE
    waiting = [(base, -1)]
    while waiting:
        node, label = waiting.pop()
        ends = bool(may_end[node])
        for d, below in _best_children(node, label, into, worth, ends, graph, grammar):
            child = int(graph.head[d])
            chosen[child] = d * LABELS + below
            waiting.append((child, below))
    return chosen, history


def _best_children(
    node: int,
    label: int,
    into: Ints,
    worth: Floats,
    may_end: bool,
    graph: GraphTable,
    grammar: GrammarTable,
) -> list[tuple[int, int]]:
    """The (edge, label) pairs that make up the worth of a node; label -1 at the base."""
    start = 0 if label < 0 else int(grammar.fresh[label])
    best: dict[int, tuple[float, list[tuple[int, int]]]] = {start: (0.0, [])}
    for d in range(graph.out_start[node], graph.out_start[node + 1]):
        child = graph.head[d]
        if into[child] != d:
            continue
        after = dict(best)
        for below in range(grammar.following.shape[1]):
            brings = graph.gain[d, below] + worth[child, below]
            if label >= 0 and graph.change[label, below] >= 0:
                brings -= graph.turn[graph.change[label, below], graph.pair_of[into[node]] + d]
            if brings <= NEVER / 2:
                continue
            for state, (total, pairs) in best.items():
                to = int(grammar.following[state, below])
                if to >= 0 and (to not in after or total + brings > after[to][0]):
                    after[to] = (total + brings, [*pairs, (d, below)])
        best = after
    if not may_end:
        best.pop(start)
    return max(best.values(), key=lambda found: found[0])[1]
