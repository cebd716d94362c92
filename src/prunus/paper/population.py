"""The population of K skeletons and its growth, one labelled edge at a time."""

from __future__ import annotations

import numpy as np

from prunus.model import Ints, SeededGraph
from prunus.paper.eligible import grammar_table
from prunus.paper.found import SearchResult, as_skeleton
from prunus.paper.kernels.propose import propose
from prunus.paper.kernels.ranks import average_ranks
from prunus.paper.kernels.resample import advance, merge_equal, resample
from prunus.paper.kernels.tables import ABSENT, BASE, GraphTable, Population
from prunus.paper.potential import path_priors
from prunus.paper.score import graph_table
from prunus.params import Parameters


def search(seeded: SeededGraph, params: Parameters, rng: np.random.Generator) -> SearchResult:
    """Grow K skeletons from the base towards the tips (sec. Population-based search).

    Returns the best over all iterations.
    """
    graph, score, cost = graph_table(seeded, params, rng)
    priors = path_priors(graph, score, cost, seeded.base, seeded.tips)
    grammar = grammar_table()
    K, most = params.search.K, params.search.k_max_rep
    population = _bare(seeded, graph, K)
    best, best_score = population.entry[0].copy(), 0.0
    history = []
    while len(population.score):
        top = int(population.score.argmax())
        history.append(population.score[top])
        if population.score[top] > best_score:
            best, best_score = population.entry[top].copy(), float(population.score[top])
        score_rank = np.empty(len(population.score))
        average_ranks(population.score, population.copies, score_rank)
        proposals = propose(graph, priors, grammar, population, score_rank, rng.random(K))
        stands, weight, live = merge_equal(graph, population, proposals)
        copies = resample(weight, K, most, rng.random(K)) if len(weight) else stands
        population = advance(graph, grammar, population, proposals, stands, live, copies)
    return SearchResult(as_skeleton(best, graph, seeded), best_score, np.array(history))


def _bare(seeded: SeededGraph, graph: GraphTable, K: int) -> Population:
    """K copies of the skeleton that holds the base alone, every tip still to be reached."""
    N, T = len(seeded.xyz), len(seeded.tips)
    leaving = np.arange(graph.out_start[seeded.base], graph.out_start[seeded.base + 1])
    entry = np.full((1, N), ABSENT, np.int32)
    entry[0, seeded.base] = BASE
    return Population(
        entry,
        np.zeros((1, N), np.int16),
        _words(np.array([seeded.base]), N),
        _words(np.arange(T), T),
        leaving.astype(np.int32),
        np.array([0, len(leaving)]),
        np.zeros(1, np.uint64),
        np.zeros(1),
        np.array([K]),
    )


def _words(members: Ints, size: int) -> np.ndarray[tuple[int, int], np.dtype[np.uint64]]:
    """A set of integers under `size` as 64-bit words (1, W)."""
    bits = np.zeros(-(-max(size, 1) // 64) * 64, np.uint8)
    bits[members] = 1
    return np.packbits(bits, bitorder="little").view("<u8").astype(np.uint64)[None, :]
