"""`python -m bench.fit_score [--trees 40] [--write]`: fit the learned score to simulated trees.

Coordinate descent on the figure that counts: one knob after the other is turned by its step as long
as the mean edit ratio over the trees falls. A knob is a weight of one label, or of all. The trees
are neither those of the edge network nor those of the experiment; half as many more are only looked
at. `--write` puts the weights and docs/score.md in place. (A structured perceptron was tried first,
and made the ratio worse.)
"""

from __future__ import annotations

import argparse
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from multiprocessing import get_context
from pathlib import Path

import numpy as np

from prunus.evaluate.correction import corrected
from prunus.evaluate.edits import Edits, edits
from prunus.experiment.orchard import Tree, tree_of
from prunus.experiment.page import markdown
from prunus.io.safely import write_bytes
from prunus.model import Label, SeededGraph
from prunus.pipeline import skeletonize
from prunus.search.learned import (
    CHANGES,
    SHIPPED,
    TERMS,
    TURNS,
    LearnedScore,
    search_learned,
)

SEEDS = 600_000
"""Trees from here on."""
LEAST = 2e-4
"""A smaller gain is none."""
STARTS_FROM = {"wood": 2.0, "length": -0.7, "confidence": 1.0, "category": 1.0}
FIRST = {(Label.SUPPORT, Label.LEADER): -0.3, (Label.TRUNK, Label.LEADER): -0.3,
         (Label.LEADER, Label.SIDE_BRANCH): -0.06}  # fmt: skip
"""What it costs to begin a branch: thick wood has more superpoints than one path can take."""
Place = tuple[str, int, int]


@dataclass(frozen=True)
class Knob:
    """Weights that are turned together: ("edge" or "turn", row, column), and the step."""

    name: str
    places: tuple[Place, ...]
    step: float

    def turned(self, score: LearnedScore, way: int) -> LearnedScore:
        """The score with the knob turned one step up or down."""
        tables = {"edge": score.edge.copy(), "turn": score.turn.copy()}
        for table, row, column in self.places:
            tables[table][row, column] += way * self.step
        return LearnedScore(tables["edge"], tables["turn"])


def knobs() -> list[Knob]:
    """All knobs: each term for all labels and for each; each change as such and its sharp half."""
    found = []
    for term, step in STEPS.items():
        column = TERMS.index(term)
        each = [("edge", int(label), column) for label in Label]
        if term not in BY_LABEL:
            found.append(Knob(f"{term}", tuple(each), step))
        found += [
            Knob(f"{term} of {label.word}", (each[label],), step)
            for label in (Label.SUPPORT, Label.LEADER, Label.SIDE_BRANCH)
        ]
    for row, (one, other) in enumerate(CHANGES):
        if Label.TRUNK in (one, other):
            continue
        name = f"{one.word}, then {other.word}"
        bins = [("turn", row, column) for column in range(len(TURNS) + 1)]
        if one != other:
            found.append(Knob(name, tuple(bins), 0.04))
        found.append(Knob(f"{name}, sharp", tuple(bins[3:]), 0.05))
    return found


STEPS = {"edge": 0.2, "length": 0.2, "wood": 0.25, "category": 0.4, "confidence": 0.4,
         "rise": 0.2, "level": 0.2}  # fmt: skip
BY_LABEL = ("edge", "rise", "level")
"""Terms that say something of a label only."""


def start() -> LearnedScore:
    """What is sensible before anything is fitted: wood pays, length and sharp turns cost."""
    edge = np.tile([STARTS_FROM.get(term, 0.0) for term in TERMS], (len(Label), 1))
    bounds = np.radians([0, *TURNS, 180])
    sharp = -0.5 * np.maximum((bounds[:-1] + bounds[1:]) / 2 - np.pi / 4, 0) ** 2
    turn = [sharp if one == other else 0 * sharp + FIRST.get((one, other), 0.0)
            for one, other in CHANGES]  # fmt: skip
    return LearnedScore(edge, np.array(turn))


@cache
def graph_of(seed: int) -> tuple[Tree, SeededGraph]:
    """A tree and the graph that the chain makes of it."""
    tree = tree_of(seed)
    return tree, skeletonize(tree.cloud, tree.truth.xyz[0], seed=seed).graph


def attempt(seed: int, score: LearnedScore) -> Edits:
    """The edits of one tree."""
    tree, graph = graph_of(seed)
    motion = graph.superpoints.cloud.to_input
    found = search_learned(graph, score).skeleton.moved(motion)
    return edits(found, corrected(found, motion.apply(graph.xyz), tree.truth, tree.counts))


def mean_ratio(pool: ProcessPoolExecutor, seeds: range, score: LearnedScore) -> float:
    """The mean edit ratio over some trees."""
    found = pool.map(attempt, seeds, [score] * len(seeds), chunksize=len(seeds) // 2)
    return float(np.mean([one.ratio for one in found]))


def fit(pool: ProcessPoolExecutor, training: range, others: range) -> LearnedScore:
    """The score after every knob was turned as far as it helps.

    Once: already then other trees gain a sixth of what these do.
    """
    score = start()
    best = mean_ratio(pool, training, score)
    print(f"start: {best:.4f}; others {mean_ratio(pool, others, score):.4f}", flush=True)
    for knob in knobs():
        for way in (1, -1):
            while (ratio := mean_ratio(pool, training, knob.turned(score, way))) < best - LEAST:
                score, best = knob.turned(score, way), ratio
                print(f"  {knob.name} {'+' if way > 0 else '-'}: {best:.4f}", flush=True)
    print(f"end: {best:.4f}; others {mean_ratio(pool, others, score):.4f}", flush=True)
    return score


def page(score: LearnedScore, trees: int) -> str:
    """docs/score.md: what was learned, in words and tables."""
    names = [label.word.replace("_", " ") for label in Label]
    terms = [
        [f"{term}: {MEANING[term]}", *(f"{value:.2f}" for value in score.edge[:, k])]
        for k, term in enumerate(TERMS)
    ]
    bounds = [0, *TURNS, 180]
    steps = [f"{low} to {high}" for low, high in pairwise(bounds)]
    turns = [
        [f"{names[one]}, then {names[other]}", *(f"{value:.3f}" for value in row)]
        for (one, other), row in zip(CHANGES, score.turn, strict=True)
    ]
    return PAGE_TEXT.format(
        trees=trees,
        terms="\n".join(markdown(["term", *names], terms)),
        turns="\n".join(markdown(["degrees", *steps], turns)),
    )


PAGE = Path(__file__).resolve().parents[1] / "docs" / "score.md"
MEANING = {
    "wood": "metres of branch that the superpoint stands for",
    "length": "metres of edge",
    "confidence": "metres x log of the edge's confidence",
    "edge": "0.1 m an edge",
    "rise": "metres up",
    "level": "metres less metres up or down",
    "category": "metres x log of the label's probability",
}
PAGE_TEXT = """# The learned score

`method = "learned"`, in place of the paper's SkelScore. The score of a skeleton
is the sum, over its edges, of the terms below times their weight for the edge's label, and of what
the turn from the edge before brings. All are in metres: a weight of 2 for wood and -1 for length
says that a metre of branch, explained by a metre of edge, brings 1; explained by two edges side by
side it brings nothing. The search (`src/prunus/search/learned.py`) seeks all labels at once, side
branches included, under the rules of `rules.py`.

Made by `python -m bench.fit_score --write` from {trees} simulated field trees that neither the edge
network nor the experiment sees: one weight after the other is turned as long as the mean edit ratio
falls. The file is `src/prunus/weights/score.toml`.

## What an edge brings

{terms}

## What a turn brings, in metres

{turns}
"""


def main() -> None:
    """Fit, and write if asked."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--trees", type=int, default=40)
    parser.add_argument("--write", action="store_true")
    chosen = parser.parse_args()
    training = range(SEEDS, SEEDS + chosen.trees)
    others = range(training.stop, training.stop + chosen.trees // 2)
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        score = fit(pool, training, others)
    print(score.to_toml())
    if chosen.write:
        write_bytes(SHIPPED, score.to_toml().encode())
        write_bytes(PAGE, page(score, chosen.trees).encode())


if __name__ == "__main__":
    main()
