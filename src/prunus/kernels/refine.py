"""Improve a finished skeleton by hanging one node at a time elsewhere.

The skeleton is completed to a tree over all reachable nodes. For such a tree the best legal labels,
and the branches better left out, follow exactly from the leaves down to the base: `worth[n, l]` is
the best sum of rewards above node n when the edge into n has label l, worked out by walking the
grammar automaton over the children of n. A move hangs a node on another neighbour; only the two
ways down to the base change, and no farther than worth changes. `may_end` says where a branch may
end: anywhere for the best SkelScore, at tips alone for a union of base-to-tip paths.
"""

from heapq import heappop, heappush

import numpy as np

from prunus.kernels.compiled import kernel
from prunus.kernels.tables import GrammarTable, GraphTable
from prunus.model.arrays import Bools, Floats, Ints

OUTSIDE = -1
"""In place of the edge into a node: the tree does not hold the node."""
ROOT = -2
"""In place of the edge into a node: the node is the base."""
NEVER = -1e18
"""Worth of what the rules forbid."""


@kernel
def complete(into: Ints, graph: GraphTable, cost: Floats) -> Ints:
    """Hang every reachable node outside the tree on it, the cheapest way; nodes, base first.

    `into` (N,) is the edge into each node, OUTSIDE or ROOT, and is filled; `cost` (D,) >= 0.
    """
    N = len(into)
    distance = np.where(into == OUTSIDE, np.inf, 0.0)
    settled = np.zeros(N, np.bool_)
    heap = [(0.0, -1)]
    heappop(heap)
    for n in range(N):
        if into[n] != OUTSIDE:
            heappush(heap, (0.0, n))
    while len(heap) > 0:
        _, n = heappop(heap)
        if settled[n]:
            continue
        settled[n] = True
        for d in range(graph.out_start[n], graph.out_start[n + 1]):
            farther = distance[n] + cost[d]
            if farther < distance[graph.head[d]]:
                distance[graph.head[d]] = farther
                into[graph.head[d]] = d
                heappush(heap, (farther, graph.head[d]))
    order = np.empty(N, np.int64)
    count = 0
    for n in range(N):
        if into[n] == ROOT:
            order[0] = n
            count = 1
    for slot in range(N):
        if slot == count:
            break
        n = order[slot]
        for d in range(graph.out_start[n], graph.out_start[n + 1]):
            if into[graph.head[d]] == d:
                order[count] = graph.head[d]
                count += 1
    return order[:count]


@kernel
def find_worth(
    n: int,
    into: Ints,
    worth: Floats,
    may_end: Bools,
    graph: GraphTable,
    grammar: GrammarTable,
    sums: Floats,
    grown: Floats,
    found: Floats,
) -> bool:
    """Write worth (L,) of node n under each incoming label into `found`; whether it changed.

    `sums` and `grown` (S,) are room for the best sum that ends in each grammar state, before and
    after a child. The states of one incoming label stand together, the fresh one first.
    """
    head, gain, following, fresh = graph.head, graph.gain, grammar.following, grammar.fresh
    S, L = following.shape
    enters = into[n]
    changed = False
    for label in range(L):
        start = 0 if enters == ROOT else fresh[label]
        stop = fresh[0] if enters == ROOT else (fresh[label + 1] if label + 1 < L else S)
        for state in range(start, stop):
            sums[state] = NEVER
        sums[start] = 0.0
        for d in range(graph.out_start[n], graph.out_start[n + 1]):
            child = head[d]
            if into[child] != d:
                continue
            for state in range(start, stop):
                grown[state] = sums[state]
            for below in range(L):
                brings = gain[d, below] + worth[child, below]
                if enters != ROOT and below == label:
                    brings -= graph.turn[graph.pair_of[enters] + d]
                if brings <= NEVER / 2:
                    continue
                for state in range(start, stop):
                    after = following[state, below]
                    if after >= 0 and sums[state] + brings > grown[after]:
                        grown[after] = sums[state] + brings
            for state in range(start, stop):
                sums[state] = grown[state]
        best = sums[start] if may_end[n] else NEVER
        for state in range(start + 1, stop):
            best = max(best, sums[state])
        found[label] = best
        changed |= best != worth[n, label]
    return changed


@kernel
def hangs_on(node: int, ancestor: int, into: Ints, tail: Ints) -> bool:
    """Whether the way from a node to the base passes the other node."""
    while node != ancestor and into[node] != ROOT:
        node = tail[into[node]]
    return node == ancestor


@kernel
def leads_nowhere(worth: Floats, node: int) -> bool:
    """Whether no branch above the node may end: then no place for it gains anything."""
    for label in range(worth.shape[1]):  # noqa: SIM110, numba has no all()
        if worth[node, label] > NEVER / 2:
            return False
    return True


@kernel
def climb(
    into: Ints,
    order: Ints,
    may_end: Bools,
    graph: GraphTable,
    grammar: GrammarTable,
    sweeps: int,
) -> Floats:
    """Try every move in turn until none gains, at most so many sweeps; the worth (N, L) reached.

    `into` (N,) is changed in place; `order` lists its nodes, base first.
    """
    tail, head = graph.tail, graph.head
    S, L = grammar.following.shape
    worth = np.full((len(into), L), NEVER)
    sums, grown, found = np.empty(S), np.empty(S), np.empty(L)
    for slot in range(len(order) - 1, -1, -1):
        find_worth(order[slot], into, worth, may_end, graph, grammar, sums, grown, found)
        worth[order[slot]] = found
    base = order[0]
    changed = np.empty(2 * len(into) + 2, np.int64)
    before = np.empty((2 * len(into) + 2, L))
    for _ in range(sweeps):
        gained = False
        for d in range(len(tail)):
            node, onto = head[d], tail[d]
            old = into[node]
            if old < 0 or old == d or into[onto] == OUTSIDE or leads_nowhere(worth, node):
                continue
            if hangs_on(onto, node, into, tail):
                continue
            total = worth[base, 0]
            into[node] = d
            count = 0
            for start in (node, tail[old], onto):
                n = start
                while True:
                    if not find_worth(n, into, worth, may_end, graph, grammar, sums, grown, found):
                        break
                    changed[count] = n
                    before[count] = worth[n]
                    worth[n] = found
                    count += 1
                    if n == base or start == node:
                        break
                    n = tail[into[n]]
            if worth[base, 0] > total:
                gained = True
                continue
            into[node] = old
            for slot in range(count - 1, -1, -1):
                worth[changed[slot]] = before[slot]
        if not gained:
            break
    return worth
