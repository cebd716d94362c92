"""The first half of a step: every addition that the drawn tips allow, with its weight.

(Secs. Determining eligible edge-label pairs, Evaluating edge-label pair additions, and Weight of
sec. Proposing and resampling candidate skeletons.)
"""

from typing import TypeVar

import numpy as np

from prunus.geometry.compiled import kernel
from prunus.model.arrays import Floats, Ints
from prunus.paper.kernels.paths import Words
from prunus.paper.kernels.ranks import average_ranks
from prunus.paper.kernels.tables import (
    LABELS,
    GrammarTable,
    GraphTable,
    Population,
    PriorTable,
    Proposals,
)

Column = TypeVar("Column", Ints, Floats)


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
    if entered_by < 0:
        return graph.gain[d, label]
    change = graph.change[entered_by % LABELS, label]
    if change < 0:
        return graph.gain[d, label]
    return graph.gain[d, label] - graph.turn[change, graph.pair_of[entered_by // LABELS] + d]


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
