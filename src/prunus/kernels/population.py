"""One step of the population search, for all candidates at once.

A skeleton is a row of N entries: for each node the code of the edge that enters it (edge * 4 +
label), or ABSENT, or BASE. Beside it stand the grammar state of each node, the node set as 64-bit
words, the tips not yet given up, the score, and a key: the exclusive or of random numbers, one
for each (edge, label). Equal sets have equal keys; equal keys are checked entry by entry, so a
collision never merges two skeletons. Equal skeletons are one row with a number of copies.

A step: `propose` lists every addition that a drawn tip allows, with its weight; `merge_equal`
makes equal results one candidate; `resample` draws the next population; `advance` writes it.
"""

from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from prunus.kernels.compiled import kernel
from prunus.kernels.paths import Words, include
from prunus.kernels.ranks import average_ranks
from prunus.model.arrays import Bools, Floats, Ints

Column = TypeVar("Column", Ints, Floats)

ABSENT = -1
"""The entry of a node outside the skeleton."""
BASE = -2
"""The entry of the base: no edge enters it."""
LABELS = 4
"""An entry is edge * LABELS + label."""


class GraphTable(NamedTuple):
    """The directed edges d, sorted by tail, and what each brings.

    tail, head (D,); out_start (N + 1,); gain (D, L) EdgeScore less GrowPenalty under each label;
    turn: TurnPenalty of d followed by d' at pair_of[d] + d'; key (D, L) random 64-bit numbers.
    """

    tail: Ints
    head: Ints
    out_start: Ints
    gain: Floats
    turn: Floats
    pair_of: Ints
    key: Words


class PriorTable(NamedTuple):
    """Path priors by tip: on_path (T, D, W); after, first, second (T, D). See `tip_paths`."""

    on_path: Words
    after: Floats
    first: Floats
    second: Floats


class GrammarTable(NamedTuple):
    """The rules as an automaton over node states.

    following (S, L) the state after one more outgoing edge of that label, -1 = illegal; fresh (L,)
    the state of a node just reached; is_open (S,) whether anything may still leave; free_turns
    (L,) how many turns a path may still make for changes of label: 2 - Order(l).
    """

    following: Ints
    fresh: Ints
    is_open: Bools
    free_turns: Ints


class Population(NamedTuple):
    """U different skeletons: entry, state (U, N), nodes (U, W), live tips (U, WT), others (U,).

    `frontier[start[u] : start[u + 1]]` are the edges that leave an open node of u for a free one.
    """

    entry: NDArray[np.int32]
    state: NDArray[np.int16]
    nodes: Words
    live: Words
    frontier: NDArray[np.int32]
    start: Ints
    key: Words
    score: Floats
    copies: Ints


class Proposals(NamedTuple):
    """Additions (Q,): the skeleton that grows, the edge, the label, the weight."""

    parent: Ints
    edge: Ints
    label: Ints
    weight: Floats


@kernel
def is_free(on_path: Words, tip: int, d: int, nodes: Words, u: int) -> bool:
    """Whether the path from d to the tip shares no node with skeleton u.

    A path out of reach holds all nodes, and is never free.
    """
    for w in range(nodes.shape[1]):  # noqa: SIM110, numba has no all()
        if on_path[tip, d, w] & nodes[u, w]:
            return False
    return True


@kernel
def reward(graph: GraphTable, entered_by: int, d: int, label: int) -> float:
    """Reward of (d, label) after the entry `entered_by` (eq. Reward)."""
    if entered_by >= 0 and entered_by % LABELS == label:
        return graph.gain[d, label] - graph.turn[graph.pair_of[entered_by // LABELS] + d]
    return graph.gain[d, label]


@kernel
def eligible_pairs(
    graph: GraphTable,
    priors: PriorTable,
    grammar: GrammarTable,
    population: Population,
    u: int,
    tip: int,
    edges: Ints,
    labels: Ints,
    potentials: Floats,
) -> int:
    """Write Eligible(S_u, tip) and the Potential of each pair; how many."""
    entry, states, nodes = population.entry, population.state, population.nodes
    frontier, tail = population.frontier, graph.tail
    following, free_turns = grammar.following, grammar.free_turns
    on_path, after = priors.on_path, priors.after
    count = 0
    for slot in range(population.start[u], population.start[u + 1]):
        d = frontier[slot]
        if not is_free(on_path, tip, d, nodes, u):
            continue
        n = tail[d]
        for label in range(following.shape[1]):
            if following[states[u, n], label] < 0:
                continue
            value = population.score[u] + reward(graph, entry[u, n], d, label) + after[tip, d]
            if free_turns[label] > 0:
                value += priors.first[tip, d]
            if free_turns[label] > 1:
                value += priors.second[tip, d]
            edges[count] = d
            labels[count] = label
            potentials[count] = value
            count += 1
    return count


@kernel
def live_tips(words: Words, tips: Ints) -> int:
    """Write the tips not given up into `tips`; how many."""
    count = 0
    for w in range(len(words)):
        rest = words[w]
        tip = 64 * w
        while rest:
            if rest & np.uint64(1):
                tips[count] = tip
                count += 1
            rest >>= np.uint64(1)
            tip += 1
    return count


@kernel
def exclude(words: Words, tip: int) -> None:
    """Take the tip out of the set."""
    words[tip >> 6] &= ~(np.uint64(1) << np.uint64(tip & 63))


@kernel
def longer(column: Column, size: int) -> Column:
    """The column in an array of that size."""
    grown = np.empty(size, column.dtype)
    grown[: len(column)] = column
    return grown


@kernel
def propose(
    graph: GraphTable,
    priors: PriorTable,
    grammar: GrammarTable,
    population: Population,
    score_rank: Floats,
    draws: Floats,
) -> Proposals:
    """Every skeleton's copies draw a tip each (`draws` (K,) uniform); all additions that allows.

    The weight of an addition is Rank(SkelScore) x Rank(Potential), once for each copy that drew
    the tip. A tip towards which nothing is eligible is given up, and another is drawn with what is
    left of the number. What a tip allows is worked out once, into columns that hold room for the
    longest possible list.
    """
    room = graph.gain.size
    T = len(priors.after)
    tips = np.empty(T, np.int64)
    ones = np.ones(room, np.int64)
    size = 4 * room
    parent, edge = np.empty(size, np.int64), np.empty(size, np.int64)
    label, weight, ranks = np.empty(size, np.int64), np.empty(size), np.empty(room)
    first, drawn, count = np.empty(T, np.int64), np.empty(T, np.int64), np.empty(T, np.int64)
    Q, member = 0, 0
    for u in range(len(population.score)):
        drawn[:] = 0
        alive = live_tips(population.live[u], tips)
        for _ in range(population.copies[u]):
            rest = draws[member]
            member += 1
            while alive > 0:
                at = min(int(rest * alive), alive - 1)
                rest = rest * alive - at
                tip = tips[at]
                if drawn[tip] == 0:
                    if Q + room > size:
                        size *= 2
                        parent, edge = longer(parent, size), longer(edge, size)
                        label, weight = longer(label, size), longer(weight, size)
                    count[tip] = eligible_pairs(
                        graph, priors, grammar, population, u, tip, edge[Q:], label[Q:], weight[Q:]
                    )
                    first[tip] = Q
                    Q += count[tip]
                if count[tip] > 0:
                    drawn[tip] += 1
                    break
                exclude(population.live[u], tip)
                alive = live_tips(population.live[u], tips)
        for tip in range(T):
            if drawn[tip] > 0:
                a, b = first[tip], first[tip] + count[tip]
                average_ranks(weight[a:b], ones[: b - a], ranks)
                parent[a:b] = u
                for q in range(a, b):
                    weight[q] = score_rank[u] * ranks[q - a] * drawn[tip]
    return Proposals(parent[:Q], edge[:Q], label[:Q], weight[:Q])


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
