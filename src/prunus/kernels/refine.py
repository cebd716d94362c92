"""Improve a finished skeleton by hanging nodes elsewhere.

The skeleton is completed to a tree over all reachable nodes. For such a tree the best legal labels,
and the branches better left out, follow exactly from the leaves down to the base: `worth[n, l]` is
the best sum of rewards above node n when the edge into n has label l, worked out by walking the
grammar automaton over the children of n. A move hangs one node, or a few at once, on other
neighbours; only the ways down to the base change, and no farther than worth changes. `may_end` says
where a branch may end: anywhere for the best score, at tips alone for a union of base-to-tip paths.
"""

from heapq import heappop, heappush
from typing import NamedTuple

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


class Room(NamedTuple):
    """Room to work in: sums that end in each grammar state (S,), and what a move has changed.

    nodes, edges, entered: what a move hangs elsewhere, by which edges, and by which before;
    changed, before: nodes whose worth it changed, and what that was.
    """

    sums: Floats
    grown: Floats
    found: Floats
    changed: Ints
    before: Floats
    nodes: Ints
    edges: Ints
    entered: Ints


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
    room: Room,
) -> bool:
    """Write worth (L,) of node n under each incoming label into `room.found`; whether it changed.

    The states of one incoming label stand together, the fresh one first.
    """
    head, gain, following, fresh = graph.head, graph.gain, grammar.following, grammar.fresh
    sums, grown = room.sums, room.grown
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
                if enters != ROOT and graph.change[label, below] >= 0:
                    brings -= graph.turn[graph.change[label, below], graph.pair_of[enters] + d]
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
        room.found[label] = best
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


class Tree(NamedTuple):
    """A complete tree: base, edge into each node (N,), worth (N, L), where it may end (N,)."""

    base: int
    into: Ints
    worth: Floats
    may_end: Bools


@kernel
def is_tree(nodes: Ints, into: Ints, tail: Ints) -> bool:
    """Whether from each of the nodes a way leads down to the base."""
    for start in nodes:
        n, steps = start, 0
        while into[n] != ROOT:
            n = tail[into[n]]
            steps += 1
            if steps > len(into):
                return False
    return True


@kernel
def try_move(k: int, tree: Tree, graph: GraphTable, grammar: GrammarTable, room: Room) -> bool:
    """Hang the first k of `room.nodes` by `room.edges` at once; undone unless that gains."""
    base, into, worth, may_end = tree
    total = worth[base, 0]
    for i in range(k):
        room.entered[i] = into[room.nodes[i]]
        into[room.nodes[i]] = room.edges[i]
    count = 0
    fine = is_tree(room.nodes[:k], into, graph.tail)
    for start in range(3 * k if fine else 0):
        n = room.nodes[start // 3]
        if start % 3 > 0:
            n = graph.tail[into[n] if start % 3 == 1 else room.entered[start // 3]]
        while find_worth(n, into, worth, may_end, graph, grammar, room):
            room.changed[count] = n
            room.before[count] = worth[n]
            worth[n] = room.found
            count += 1
            if n == base:
                break
            n = graph.tail[into[n]]
    if fine and worth[base, 0] > total:
        return True
    for slot in range(count - 1, -1, -1):
        worth[room.changed[slot]] = room.before[slot]
    for i in range(k):
        into[room.nodes[i]] = room.entered[i]
    return False


@kernel
def edge_between(one: int, other: int, graph: GraphTable) -> int:
    """The directed edge from a node to another; -1 where there is none."""
    for d in range(graph.out_start[one], graph.out_start[one + 1]):
        if graph.head[d] == other:
            return d
    return -1


@kernel
def try_all_with(d: int, tree: Tree, graph: GraphTable, grammar: GrammarTable, room: Room) -> bool:
    """Hang the head of edge `d` on its tail, or trade places there; whether that gained.

    Another child of the tail then hangs where the head hung before, or on the head.
    """
    node, onto = graph.head[d], graph.tail[d]
    nodes, edges = room.nodes, room.edges
    before = graph.tail[tree.into[node]]
    nodes[0], edges[0] = node, d
    if try_move(1, tree, graph, grammar, room):
        return True
    for e in range(graph.out_start[onto], graph.out_start[onto + 1]):
        nodes[1] = graph.head[e]
        if tree.into[nodes[1]] != e or nodes[1] == node:
            continue
        for place in (before, node):
            edges[1] = edge_between(place, nodes[1], graph)
            if edges[1] >= 0 and try_move(2, tree, graph, grammar, room):
                return True
    return False


@kernel
def climb(
    into: Ints, order: Ints, may_end: Bools, graph: GraphTable, grammar: GrammarTable, sweeps: int
) -> tuple[Floats, Floats]:
    """Try every move in turn, sweep after sweep, until none gains.

    `into` (N,) is changed in place; `order` lists its nodes, base first. Returns the worth (N, L)
    reached, and that of the base before the first sweep and after each.
    """
    S, L = grammar.following.shape
    N = len(into)
    worth = np.full((N, L), NEVER)
    two = np.empty(2, np.int64)
    room = Room(
        np.empty(S), np.empty(S), np.empty(L), np.empty(8 * N + 8, np.int64),
        np.empty((8 * N + 8, L)), two, two.copy(), two.copy(),
    )  # fmt: skip
    base = order[0]
    tree = Tree(base, into, worth, may_end)
    for slot in range(len(order) - 1, -1, -1):
        find_worth(order[slot], into, worth, may_end, graph, grammar, room)
        worth[order[slot]] = room.found
    history = np.empty(sweeps + 1)
    history[0] = worth[base, 0]
    for sweep in range(1, sweeps + 1):
        for d in range(len(graph.tail)):
            node, onto = graph.head[d], graph.tail[d]
            if into[node] < 0 or into[node] == d or into[onto] == OUTSIDE:
                continue
            if not leads_nowhere(worth, node) and not hangs_on(onto, node, into, graph.tail):
                try_all_with(d, tree, graph, grammar, room)
        history[sweep] = worth[base, 0]
        if history[sweep] == history[sweep - 1]:
            return worth, history[: sweep + 1].copy()
    return worth, history
