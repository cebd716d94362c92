"""Beyond the paper: a score learned from simulated trees, and the search for its best skeleton.

The paper names a likelihood in place of its hand-made score as what comes next. This one is a sum
over the skeleton of terms that can be read one by one (docs/score.md shows what they came to be):

- wood: a superpoint pays, once, for the metres of branch that it stands for. What a skeleton has
  explained cannot pay again, so that two parallel paths along one branch cost more than one;
- length: every metre of edge costs, and more so where its confidence is low or its label unlikely
  by the network's category, which sees thickness and context;
- rise: up or down, level or upright, by label;
- turns: how sharply an edge goes on from the one before, by both labels.

All labels are sought at once, side branches among them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from prunus.errors import PrunusError
from prunus.kernels.propose import reward
from prunus.kernels.tables import ABSENT, BASE, LABELS, GraphTable
from prunus.model import (
    CandidateGraph,
    Floats,
    Ints,
    Label,
    ScoredGraph,
    SeededGraph,
    Skeleton,
)  # fmt: skip
from prunus.params import Parameters
from prunus.reading import read_toml
from prunus.search.directed import Directed
from prunus.search.eligible import grammar_table
from prunus.search.refine import refine
from prunus.search.result import SearchResult, as_skeleton
from prunus.search.score import exact

SHIPPED = Path(__file__).parents[1] / "weights" / "score.toml"
"""The score that the package ships, made by `bench/fit_score.py`."""
TERMS = ("wood", "length", "confidence", "edge", "rise", "level", "category")
"""What each edge brings, in metres; see `edge_terms`."""
TURNS = (12, 25, 40, 60, 85)
"""Turns are told apart at these angles, degrees."""
CHANGES = tuple(
    (before, after)
    for before in Label
    for after in Label
    if after in (before, before + 1) or (before, after) == (Label.TRUNK, Label.LEADER)
)
"""The labels of two edges, one after the other, whose turns count."""
MOST_WOOD = 0.15
"""No superpoint stands for more, metres."""
LEAST = 0.02
"""Probabilities below are taken for it."""
STEP = 0.1
"""An edge as such counts as so many metres."""
DEAR = 0.02
"""Even a sure edge costs so much of its length on the way to a superpoint."""


@dataclass(frozen=True, eq=False)
class LearnedScore:
    """Weights: edge (L, TERMS) by label; turn (CHANGES, TURNS + 1)."""

    edge: Floats
    turn: Floats

    @classmethod
    def from_toml(cls, path: Path) -> LearnedScore:
        """The score in a file; PrunusError naming it where it is none."""
        held = read_toml(path)
        try:
            edge = [[float(held["edge"][label.word][term]) for term in TERMS] for label in Label]
            turn = [[float(x) for x in held["turn"][a.word][b.word]] for a, b in CHANGES]
            return cls(np.array(edge), np.array(turn).reshape(len(CHANGES), len(TURNS) + 1))
        except (KeyError, TypeError, ValueError) as error:
            raise PrunusError(f"{path}: not a learned score ({error})") from error

    def to_toml(self) -> str:
        """The file that `from_toml` reads."""
        lines = ["# A learned score, made by `python -m bench.fit_score`; see docs/score.md."]
        for label, row in zip(Label, self.edge, strict=True):
            lines += ["", f"[edge.{label.word}]"]
            lines += [f"{term} = {value:.4f}" for term, value in zip(TERMS, row, strict=True)]
        bounds = " ".join(str(angle) for angle in TURNS)
        for before in Label:
            lines += ["", f"[turn.{before.word}]  # split at {bounds} degrees"]
            for (one, after), row in zip(CHANGES, self.turn, strict=True):
                if one == before:
                    lines.append(f"{after.word} = [{', '.join(f'{x:.4f}' for x in row)}]")
        return "\n".join(lines) + "\n"


@cache
def shipped_score() -> LearnedScore:
    """The score that the package ships."""
    return LearnedScore.from_toml(SHIPPED)


def edge_terms(seeded: SeededGraph, ways: Directed) -> Floats:
    """The terms (D, L, TERMS) of every directed edge under every label, metres.

    wood of its head; length; length x log confidence; `STEP`; how far it rises; length x how level
    it is; length x log probability of the label, which takes a scorer that tells categories.
    """
    length, up = ways.length, ways.vector[:, 2]
    confidence = np.maximum(seeded.confidence[ways.edge], LEAST)
    category = np.maximum(seeded.scored.category[ways.edge][:, : len(Label)], LEAST)
    alike = [
        np.minimum(seeded.superpoints.wood, MOST_WOOD)[ways.head],
        length,
        length * np.log(confidence),
        np.full(len(length), STEP),
        up,
        length - np.abs(up),
    ]
    terms = np.empty((len(length), len(Label), len(TERMS)))
    terms[:, :, :-1] = np.stack(alike, axis=1)[:, None]
    terms[:, :, -1] = length[:, None] * np.log(category)
    return terms


def turn_steps(ways: Directed) -> Ints:
    """For every pair of edges, one after the other, between which of `TURNS` the turn lies."""
    first, second = ways.pairs()
    cosine = (ways.vector[first] * ways.vector[second]).sum(axis=1)
    cosine /= ways.length[first] * ways.length[second]
    return np.asarray(np.searchsorted(-np.cos(np.radians(TURNS)), -cosine))


def learned_table(seeded: SeededGraph, ways: Directed, score: LearnedScore) -> GraphTable:
    """The directed edges with what they bring under each label, and what each turn costs."""
    gain = np.einsum("dlt,lt->dl", edge_terms(seeded, ways), score.edge)
    change = np.full((len(Label), len(Label)), -1)
    for kind, (before, after) in enumerate(CHANGES):
        change[before, after] = kind
    return GraphTable(
        ways.tail,
        ways.head,
        ways.out_start,
        exact(gain),
        exact(-score.turn[:, turn_steps(ways)]),
        ways.pair_of,
        change,
        np.zeros((0, 0), np.uint64),
    )


def search_learned(seeded: SeededGraph, score: LearnedScore) -> SearchResult:
    """The best skeleton found under a learned score, side branches included; its score by sweep.

    The climb begins with the cheapest way from the base to every superpoint (Len (1 - Conf)).
    """
    ways = Directed.of(seeded)
    table = learned_table(seeded, ways, score)
    entry = np.full(len(seeded.xyz), ABSENT, np.int32)
    entry[seeded.base] = BASE
    cost = ways.length * (1 - (1 - DEAR) * seeded.confidence[ways.edge])
    anywhere = np.ones(len(entry), np.bool_)
    best, history = refine(entry, table, grammar_table(tuple(Label)), cost, anywhere)
    return SearchResult(as_skeleton(best, table, seeded), float(history[-1]), history)


def goes_by_learned_score(seeded: SeededGraph, params: Parameters) -> bool:
    """Whether the learned score is asked for, and the scorer tells the categories it takes."""
    return params.method == "learned" and seeded.scored.category.size > 0


def learned_score_of(skeleton: Skeleton, seeded: SeededGraph, score: LearnedScore) -> float:
    """The learned score of any skeleton on these superpoints.

    Edges that are no candidates have no confidence.
    """
    ends = np.sort(skeleton.superpoint[skeleton.edges], axis=1).tolist()
    known = set(map(tuple, seeded.edges.tolist()))
    absent = [pair for pair in ends if tuple(pair) not in known]
    more = _with_edges(seeded, np.array(absent, np.int64).reshape(-1, 2))
    ways = Directed.of(more)
    table = learned_table(more, ways, score)
    heads = zip(ways.tail.tolist(), ways.head.tolist(), strict=True)
    number = {pair: d for d, pair in enumerate(heads)}
    total, entry = 0.0, [BASE]
    for row, (above, node) in enumerate(skeleton.superpoint[skeleton.edges].tolist(), 1):
        d, label = number[above, node], int(skeleton.label[row])
        total += reward(table, entry[skeleton.parent[row]], d, label)
        entry.append(d * LABELS + label)
    return total


def _with_edges(seeded: SeededGraph, absent: Ints) -> SeededGraph:
    """The same graph with further candidate edges, of which nothing is known."""
    scored = seeded.scored
    kinds = scored.category.shape[1]
    return SeededGraph(
        ScoredGraph(
            CandidateGraph(seeded.superpoints, np.concatenate([seeded.edges, absent])),
            np.concatenate([scored.confidence, np.zeros(len(absent))]),
            np.concatenate([scored.category, np.full((len(absent), kinds), 1 / kinds)]),
            scored.scorer,
        ),
        seeded.base,
        seeded.tips,
    )
