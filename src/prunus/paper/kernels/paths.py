"""Path priors: from every directed edge the cheapest way to a tip (eq. Cost)."""

from heapq import heappop, heappush

import numpy as np
from numpy.typing import NDArray

from prunus.geometry.compiled import kernel
from prunus.model.arrays import Floats, Ints

Words = NDArray[np.uint64]


@kernel
def contains(words: Words, node: int) -> bool:
    """Whether the node is in the set."""
    return (words[node >> 6] >> np.uint64(node & 63)) & np.uint64(1) != 0


@kernel
def include(words: Words, node: int) -> None:
    """Put the node into the set."""
    words[node >> 6] |= np.uint64(1) << np.uint64(node & 63)


@kernel
def tip_paths(
    tip: int,
    base: int,
    tail: Ints,
    head: Ints,
    into_start: Ints,
    into: Ints,
    cost: Floats,
    score: Floats,
    turn: Floats,
    pair_of: Ints,
    on_path: Words,
    after: Floats,
    first: Floats,
    second: Floats,
) -> Ints:
    """Dijkstra from the tip backwards over directed edges; a state is an edge.

    Returns the edge that follows each edge on its path (D,): itself at the tip, -1 where the tip
    is out of reach. Fills, for each edge d: `on_path` (D, W) the nodes of its path after its tail,
    `after` the sum of EdgeScore (`score`) of the edges after d less all turn penalties from d on,
    `first` and `second` the two largest of those penalties. Paths visit no node twice and pass
    through no base. The turn from d into an edge `follower` is `turn[pair_of[d] + follower]`.
    """
    D = len(tail)
    distance = np.full(D, np.inf)
    following = np.full(D, -1, np.int64)
    settled = np.zeros(D, np.bool_)
    heap = [(0.0, -1)]
    heappop(heap)
    for slot in range(into_start[tip], into_start[tip + 1]):
        d = into[slot]
        distance[d] = 0.0
        following[d] = d
        heappush(heap, (0.0, d))
    while len(heap) > 0:
        _, d = heappop(heap)
        if settled[d]:
            continue
        settled[d] = True
        follower = following[d]
        if follower == d:
            on_path[d, :] = 0
        else:
            penalty = turn[pair_of[d] + follower]
            for w in range(on_path.shape[1]):
                on_path[d, w] = on_path[follower, w]
            after[d] = after[follower] + score[follower] - penalty
            first[d] = max(first[follower], penalty)
            second[d] = max(second[follower], min(first[follower], penalty))
        include(on_path[d], head[d])
        if tail[d] == base:
            continue
        for slot in range(into_start[tail[d]], into_start[tail[d] + 1]):
            before = into[slot]
            if settled[before] or contains(on_path[d], tail[before]):
                continue
            longer = distance[d] + cost[d] + turn[pair_of[before] + d]
            if longer < distance[before]:
                distance[before] = longer
                following[before] = d
                heappush(heap, (longer, before))
    return following
