"""The fast search computes what the slow twin computes, step by step."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prunus.model import CandidateGraph, ScoredGraph, SeededGraph
from prunus.paper.eligible import grammar_table
from prunus.paper.kernels.propose import eligible_pairs, live_tips, propose
from prunus.paper.kernels.ranks import average_ranks
from prunus.paper.kernels.resample import advance, merge_equal, resample
from prunus.paper.kernels.tables import ABSENT, LABELS, Population
from prunus.paper.population import _bare, search
from prunus.paper.potential import path_priors
from prunus.paper.score import graph_table, skel_score
from prunus.params import Parameters
from tests.paper.graphs import as_pairs, orchard, random_graph
from tests.reference import Orchard, Pairs

PARAMS = Parameters.paper()


class Steps:
    """A search stopped after some iterations, with all its tables."""

    def __init__(self, seeded: SeededGraph, iterations: int, K: int = 40) -> None:
        self.seeded, self.K = seeded, K
        self.rng = np.random.default_rng(1)
        self.graph, score, cost = graph_table(seeded, PARAMS, self.rng)
        self.priors = path_priors(self.graph, score, cost, seeded.base, seeded.tips)
        self.grammar = grammar_table()
        self.population = _bare(seeded, self.graph, K)
        for _ in range(iterations):
            _, proposals, stands, weight, live = self.step()
            if len(weight) == 0:
                break
            copies = resample(weight, K, 3, self.rng.random(K))
            self.population = advance(
                self.graph, self.grammar, self.population, proposals, stands, live, copies
            )

    def step(self) -> tuple:
        rank = np.empty(len(self.population.score))
        average_ranks(self.population.score, self.population.copies, rank)
        draws = self.rng.random(self.K)
        proposals = propose(self.graph, self.priors, self.grammar, self.population, rank, draws)
        return draws, proposals, *merge_equal(self.graph, self.population, proposals)

    def pairs(self, u: int) -> Pairs:
        codes = [int(code) for code in self.population.entry[u] if code >= 0]
        return frozenset((self.edge(code // LABELS), code % LABELS) for code in codes)

    def edge(self, d: int) -> tuple[int, int]:
        return int(self.graph.tail[d]), int(self.graph.head[d])

    def eligible(self, u: int, tip: int) -> dict:
        size = self.graph.gain.size
        edges, labels = np.empty(size, np.int64), np.empty(size, np.int64)
        potentials = np.empty(size)
        count = eligible_pairs(
            self.graph,
            self.priors,
            self.grammar,
            self.population,
            u,
            tip,
            edges,
            labels,
            potentials,
        )
        return {
            (self.edge(int(edges[i])), int(labels[i])): float(potentials[i]) for i in range(count)
        }


@settings(deadline=None, max_examples=25)
@given(seed=st.integers(0, 10_000), iterations=st.integers(0, 6))
def test_eligible_pairs_and_potentials_are_those_of_the_slow_twin(
    seed: int, iterations: int
) -> None:
    seeded = random_graph(seed)
    fast, slow = Steps(seeded, iterations), orchard(seeded, PARAMS)
    for row, tip in enumerate(seeded.tips.tolist()):
        paths = slow.paths(tip)
        for u in range(min(len(fast.population.score), 5)):
            skeleton = fast.pairs(u)
            found = fast.eligible(u, row)
            assert set(found) == slow.eligible(skeleton, paths)
            for (edge, label), potential in found.items():
                expected = slow.potential(skeleton, edge, label, paths[edge])
                assert potential == pytest.approx(expected, abs=1e-7)


@settings(deadline=None, max_examples=25)
@given(seed=st.integers(0, 10_000), iterations=st.integers(0, 6))
def test_scores_are_those_of_the_slow_twin(seed: int, iterations: int) -> None:
    seeded = random_graph(seed)
    fast, slow = Steps(seeded, iterations), orchard(seeded, PARAMS)
    for u in range(len(fast.population.score)):
        assert fast.population.score[u] == pytest.approx(slow.score(fast.pairs(u)), abs=1e-7)


@settings(deadline=None, max_examples=25)
@given(seed=st.integers(0, 10_000), iterations=st.integers(0, 5))
def test_weights_are_those_of_the_slow_twin(seed: int, iterations: int) -> None:
    seeded = random_graph(seed)
    fast, slow = Steps(seeded, iterations, K=12), orchard(seeded, PARAMS)
    before = fast.population
    rows = [u for u in range(len(before.score)) for _ in range(before.copies[u])]
    alive = [tips_alive(words, len(seeded.tips)) for words in before.live]
    draws, proposals, stands, weight, _ = fast.step()
    priors = [slow.paths(int(tip)) for tip in seeded.tips]
    skeletons = [fast.pairs(u) for u in rows]
    drawn = [
        drawn_tip(alive[u], draw, skeleton, priors, slow)
        for u, draw, skeleton in zip(rows, draws, skeletons, strict=False)
    ]
    expected = slow.weights(skeletons, [None if t is None else int(seeded.tips[t]) for t in drawn])
    found = {}
    for q, total in zip(stands, weight, strict=True):
        pair = (fast.edge(int(proposals.edge[q])), int(proposals.label[q]))
        found[fast.pairs(int(proposals.parent[q])) | {pair}] = total
    assert found == pytest.approx(expected)


def tips_alive(words: np.ndarray, count: int) -> list[int]:
    buffer = np.empty(count, np.int64)
    return buffer[: live_tips(words, buffer)].tolist()


def drawn_tip(
    alive: list[int], draw: float, skeleton: Pairs, priors: list, slow: Orchard
) -> int | None:
    """The tip that a copy draws. One that leads nowhere is given up, for the copies to come too."""
    while alive:
        at = min(int(draw * len(alive)), len(alive) - 1)
        draw = draw * len(alive) - at
        if slow.eligible(skeleton, priors[alive[at]]):
            return alive[at]
        alive.pop(at)
    return None


def test_a_collision_of_keys_never_merges_two_skeletons() -> None:
    fast = Steps(random_graph(3), 3)
    honest = len(fast.step()[2])
    fast.graph = fast.graph._replace(key=np.zeros_like(fast.graph.key))
    fast.population = fast.population._replace(key=np.zeros_like(fast.population.key))
    fast.rng = np.random.default_rng(1)
    once = fast.step()
    skeletons = {
        fast.pairs(int(once[1].parent[q]))
        | {(fast.edge(int(once[1].edge[q])), int(once[1].label[q]))}
        for q in once[2]
    }
    assert len(skeletons) == len(once[2])
    assert honest > 1


@settings(deadline=None, max_examples=40)
@given(seed=st.integers(0, 10_000), count=st.integers(1, 60), K=st.integers(1, 90))
def test_resampling_draws_k_and_none_too_often(seed: int, count: int, K: int) -> None:
    rng = np.random.default_rng(seed)
    copies = resample(rng.uniform(0.01, 1, count), K, 3, rng.random(K))
    assert copies.sum() == K
    if count * 3 > K:
        assert copies.max() <= 3
    else:
        assert copies.max() - copies.min() <= 1


def test_resampling_follows_the_weights() -> None:
    rng = np.random.default_rng(0)
    weight = np.array([1.0, 2.0, 3.0, 4.0])
    total = sum(resample(weight, 1, 3, rng.random(1)) for _ in range(4000))
    assert total / 4000 == pytest.approx(weight / 10, abs=0.03)


@pytest.mark.parametrize("seed", range(12))
def test_the_answer_is_legal_and_scores_the_sum_of_its_rewards(seed: int) -> None:
    seeded = random_graph(seed, nodes=14, edges=26)
    slow = orchard(seeded, PARAMS)
    found = search(seeded, PARAMS, np.random.default_rng(seed))
    pairs = as_pairs(found.skeleton)
    assert slow.is_legal(pairs)
    assert found.score == pytest.approx(slow.score(pairs), abs=1e-7)
    assert found.score == pytest.approx(skel_score(found.skeleton, PARAMS), abs=1e-7)
    assert found.score >= found.history.max()


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.slow
def test_nothing_beats_the_exhaustive_optimum_and_little_is_lost(seed: int) -> None:
    seeded = random_graph(seed, nodes=7, edges=9, tips=6)
    _, optimum = orchard(seeded, PARAMS).best()
    found = search(seeded, PARAMS, np.random.default_rng(seed)).score
    assert found <= optimum + 1e-7
    assert found >= 0.99 * optimum


def test_a_base_with_no_edge_gives_the_base_alone() -> None:
    graph = random_graph(0)
    away = ~(graph.edges == 0).any(axis=1)
    candidates = CandidateGraph(graph.superpoints, graph.edges[away])
    cut = SeededGraph(
        ScoredGraph.of_confidence(candidates, graph.confidence[away], "cut"), 0, np.array([8])
    )
    found = search(cut, PARAMS, np.random.default_rng(0))
    assert len(found.skeleton) == 1
    assert found.score == 0


def test_the_first_population_is_the_base_alone() -> None:
    seeded = random_graph(0)
    table, _, _ = graph_table(seeded, PARAMS, np.random.default_rng(0))
    population: Population = _bare(seeded, table, 5)
    assert (population.entry == ABSENT).sum() == 8
    assert population.copies.tolist() == [5]
