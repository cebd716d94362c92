"""The second half of a step: equal results become one candidate, K are drawn and written down.

Equal sets of (edge, label) pairs have equal keys; equal keys are checked entry by entry, so a
collision never merges two skeletons. (Sec. Proposing and resampling candidate skeletons.)
"""

import numpy as np

from prunus.geometry.compiled import kernel
from prunus.model.arrays import Floats, Ints
from prunus.paper.kernels.paths import Words, include
from prunus.paper.kernels.propose import reward
from prunus.paper.kernels.tables import (
    ABSENT,
    LABELS,
    GrammarTable,
    GraphTable,
    Population,
    Proposals,
)


@kernel
def are_equal(graph: GraphTable, population: Population, out: Proposals, i: int, j: int) -> bool:
    """Whether proposals i and j make the same set of (edge, label) pairs.

    From one skeleton they do when the pair is the same. From two different ones they do when each
    skeleton already holds the pair that the other adds, and they agree everywhere else.
    """
    code_i = out.edge[i] * LABELS + out.label[i]
    code_j = out.edge[j] * LABELS + out.label[j]
    if out.parent[i] == out.parent[j]:
        return code_i == code_j
    row_i = population.entry[out.parent[i]]
    row_j = population.entry[out.parent[j]]
    if row_j[graph.head[out.edge[i]]] != code_i or row_i[graph.head[out.edge[j]]] != code_j:
        return False
    different = 0
    for n in range(len(row_i)):
        different += row_i[n] != row_j[n]
    return different == 2


@kernel
def merge_equal(
    graph: GraphTable, population: Population, out: Proposals
) -> tuple[Ints, Floats, Words]:
    """Make equal proposals one candidate, by an open hash table over their keys.

    Returns the proposal (C,) that stands for each candidate, the sum (C,) of the weights, and the
    tips (C, WT) that some parent has not given up.
    """
    Q = len(out.parent)
    slots = 16
    while slots < 2 * Q:
        slots *= 2
    table = np.full(slots, -1, np.int64)
    key = np.empty(Q, np.uint64)
    stands = np.empty(Q, np.int64)
    weight = np.empty(Q)
    live = np.empty((Q, population.live.shape[1]), np.uint64)
    C = 0
    for q in range(Q):
        parent = out.parent[q]
        own = population.key[parent] ^ graph.key[out.edge[q], out.label[q]]
        slot = np.int64(own & np.uint64(slots - 1))
        while table[slot] >= 0:
            c = table[slot]
            if key[c] == own and are_equal(graph, population, out, q, stands[c]):
                break
            slot = (slot + 1) & (slots - 1)
        if table[slot] < 0:
            table[slot] = C
            key[C] = own
            stands[C] = q
            weight[C] = 0.0
            live[C] = 0
            C += 1
        c = table[slot]
        weight[c] += out.weight[q]
        for w in range(live.shape[1]):
            live[c, w] |= population.live[parent, w]
    return stands[:C].copy(), weight[:C].copy(), live[:C].copy()


@kernel
def resample(weight: Floats, K: int, most: int, draws: Floats) -> Ints:
    """How often (C,) each candidate is drawn: K in all, by weight, none more than `most` times.

    Where that leaves too few, all are taken equally often, and the remainder by weight. The sums
    of the weights left stand in a binary tree, so that a draw (`draws` (K,) uniform) takes log C.
    """
    C = len(weight)
    copies = np.zeros(C, np.int64)
    if C * most <= K:
        copies[:] = K // C
        most = K // C + 1
        K -= C * (K // C)
    leaves = 1
    while leaves < C:
        leaves *= 2
    total = np.zeros(2 * leaves)
    total[leaves : leaves + C] = weight
    for node in range(leaves - 1, 0, -1):
        total[node] = total[2 * node] + total[2 * node + 1]
    for k in range(K):
        target = draws[k] * total[1]
        node = 1
        while node < leaves:
            node *= 2
            if target >= total[node] and total[node + 1] > 0.0:
                target -= total[node]
                node += 1
        copies[node - leaves] += 1
        if copies[node - leaves] == most:
            total[node] = 0.0
            while node > 1:
                node //= 2
                total[node] = total[2 * node] + total[2 * node + 1]
    return copies


@kernel
def advance(
    graph: GraphTable,
    grammar: GrammarTable,
    old: Population,
    out: Proposals,
    stands: Ints,
    live: Words,
    copies: Ints,
) -> Population:
    """The population of the candidates that were drawn at least once."""
    tails, heads, out_start = graph.tail, graph.head, graph.out_start
    U, room = 0, 0
    for c in range(len(copies)):
        if copies[c] > 0:
            parent, head = out.parent[stands[c]], heads[out.edge[stands[c]]]
            room += old.start[parent + 1] - old.start[parent]
            room += out_start[head + 1] - out_start[head]
            U += 1
    N = old.entry.shape[1]
    entry, state = np.empty((U, N), np.int32), np.empty((U, N), np.int16)
    nodes = np.empty((U, old.nodes.shape[1]), np.uint64)
    frontier, start = np.empty(room, np.int32), np.zeros(U + 1, np.int64)
    lives = np.empty((U, old.live.shape[1]), np.uint64)
    key, score, many = np.empty(U, np.uint64), np.empty(U), np.empty(U, np.int64)
    u = 0
    for c in range(len(copies)):
        if copies[c] == 0:
            continue
        parent, d, label = out.parent[stands[c]], out.edge[stands[c]], out.label[stands[c]]
        tail, head = tails[d], heads[d]
        for n in range(N):
            entry[u, n] = old.entry[parent, n]
            state[u, n] = old.state[parent, n]
        entry[u, head] = d * LABELS + label
        state[u, tail] = grammar.following[old.state[parent, tail], label]
        state[u, head] = grammar.fresh[label]
        nodes[u] = old.nodes[parent]
        include(nodes[u], head)
        closed = not grammar.is_open[state[u, tail]]
        end = start[u]
        for slot in range(old.start[parent], old.start[parent + 1]):
            other = old.frontier[slot]
            frontier[end] = other
            end += heads[other] != head and not (closed and tails[other] == tail)
        for other in range(out_start[head], out_start[head + 1]):
            frontier[end] = other
            end += entry[u, heads[other]] == ABSENT
        start[u + 1] = end
        lives[u] = live[c]
        key[u] = old.key[parent] ^ graph.key[d, label]
        score[u] = old.score[parent] + reward(graph, old.entry[parent, tail], d, label)
        many[u] = copies[c]
        u += 1
    return Population(entry, state, nodes, lives, frontier, start, key, score, many)
