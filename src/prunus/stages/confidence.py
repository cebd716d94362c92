"""Edge confidence through replaceable scorers (sec. Edge evaluation)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from prunus.kernels.frames import HIGH, WIDE
from prunus.model import Bools, CandidateGraph, Floats, ScoredGraph
from prunus.params import Confidence
from prunus.stages.images import edge_images


class EdgeScorer(Protocol):
    """Whoever gives each candidate edge a confidence (E,) in [0, 1]."""

    @property
    def name(self) -> str:
        """What reports call it."""

    @property
    def floor(self) -> float:
        """Edges under this confidence are better left out."""

    def __call__(self, candidates: CandidateGraph) -> Floats:
        """Conf(e) for every candidate edge."""


@runtime_checkable
class CategoryScorer(EdgeScorer, Protocol):
    """One who also tells what wood an edge is: the learned score asks for that."""

    def judge(self, candidates: CandidateGraph) -> tuple[Floats, Floats]:
        """Conf(e), and the probability (E, 5) of each category should the edge be valid."""


def score_edges(candidates: CandidateGraph, scorer: EdgeScorer) -> ScoredGraph:
    """The candidates with the confidence that the scorer gives."""
    if isinstance(scorer, CategoryScorer):
        return ScoredGraph(candidates, *scorer.judge(candidates), scorer.name)
    return ScoredGraph.of_confidence(candidates, scorer(candidates), scorer.name)


def hopeful(scored: ScoredGraph, scorer: EdgeScorer, params: Confidence) -> ScoredGraph:
    """The graph less its hopeless edges.

    A branch with a gap has poor edges, worth crossing for what lies beyond; but an edge that is
    all but certainly none would tie another tree to this one for a small price.
    """
    kept = scored.confidence >= (scorer.floor if params.floor == "auto" else params.floor)
    left = CandidateGraph(scored.candidates.superpoints, scored.edges[kept])
    return ScoredGraph(left, scored.confidence[kept], scored.category[kept], scored.scorer)


@dataclass(frozen=True)
class ConstantScorer:
    """Every edge the same: the scorer that does nothing."""

    value: float = 1.0
    name: str = "constant"
    floor: float = 0.0

    def __call__(self, candidates: CandidateGraph) -> Floats:
        """The constant (E,)."""
        return np.full(len(candidates.edges), self.value)


@dataclass(frozen=True)
class HandmadeScorer:
    """How evenly and how tightly the points fill the edge, and how well they line up with it.

    A logistic function of four features of the edge image, fitted by `bench/fit_handmade.py` to
    the edges of sixty simulated field scans, split by tree. On trees it had not seen it told 79 %
    of the edges right (area under the ROC curve 0.89): the baseline of the networks.
    """

    name: str = "handmade"
    floor: float = 0.05

    def __call__(self, candidates: CandidateGraph) -> Floats:
        """Confidence (E,)."""
        vectors = candidates.xyz[candidates.edges[:, 1]] - candidates.xyz[candidates.edges[:, 0]]
        lengths = np.linalg.norm(vectors, axis=1) / candidates.superpoints.radius
        features = image_features(edge_images(candidates), lengths)
        return np.asarray(1 / (1 + np.exp(-(features @ WEIGHTS + OFFSET))))


WEIGHTS = np.array([5.88, -5.60, 1.19, 1.85])
OFFSET = -2.9
"""Logistic weights of `image_features`. Points off the edge tell against it, less so where they
drift to one side together: that is a branch that bends, not two branches or noise.
"""


def image_features(images: NDArray[np.float32], lengths: Floats) -> Floats:
    """Features (E, 4) of edge images (E, 16, 32), for edges of so many r_super (E,).

    All look at the columns between the two ends. tightness: share of the points within r / 4 of
    the edge; gap: longest run without points within 0.4 r, in r; thinnest: the emptiest of all
    three neighbouring columns against their mean; drift: root mean square over the points of the
    offset of their column's mean, in r.
    """
    x = (np.arange(WIDE) + 0.5) * 4 / WIDE - 2
    y = (np.arange(HIGH) + 0.5) * 2 / HIGH - 1
    between = np.abs(x) <= np.maximum(lengths[:, None] / 2, 4 / WIDE)
    columns = between.sum(axis=1)

    fill = images.sum(axis=1, dtype=np.float64)
    narrow = images[:, np.abs(y) < 0.25].sum(axis=1, dtype=np.float64)
    core = images[:, np.abs(y) < 0.4].sum(axis=1, dtype=np.float64)
    total = np.maximum((fill * between).sum(axis=1), TINY)
    tightness = (narrow * between).sum(axis=1) / total

    mean = (core * between).sum(axis=1) / columns
    gap = longest_run(between & (core < 0.1 * np.maximum(mean, TINY)[:, None])) * 4 / WIDE

    threes = narrow[:, :-2] + narrow[:, 1:-1] + narrow[:, 2:]
    inner = between[:, 1:-1]
    usual = np.maximum((threes * inner).sum(axis=1) / columns, TINY)
    thinnest = np.where(inner, threes, np.inf).min(axis=1) / usual

    offset = np.einsum("ehw,h->ew", images, y) / np.maximum(fill, TINY)
    drift = np.sqrt((offset**2 * fill * between).sum(axis=1) / total)
    return np.column_stack([tightness, gap, thinnest, drift])


def longest_run(marked: Bools) -> Floats:
    """The longest run of marked columns (E,) in each row (E, W)."""
    run, longest = np.zeros(len(marked)), np.zeros(len(marked))
    for column in marked.T:
        run = (run + 1) * column
        longest = np.maximum(longest, run)
    return longest


TINY = 1e-9
