"""Edge confidence through replaceable scorers (sec. Edge evaluation)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from prunus.errors import PrunusError
from prunus.kernels.frames import HIGH, WIDE
from prunus.model import Bools, CandidateGraph, Floats, Label, ScoredGraph
from prunus.model.arrays import Shape, frozen
from prunus.params import Confidence
from prunus.stages.images import edge_images


class EdgeScorer(Protocol):
    """Whoever gives each candidate edge a confidence (E,) in [0, 1], finite."""

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
        """Conf(e), and the probability (E, 5) of each category should the edge be valid.

        The categories are trunk, support, leader, side branch and other wood; rows sum to 1.
        """


def check_scorer(scorer: Any) -> None:
    """Raise PrunusError where somebody's own scorer is not what `EdgeScorer` asks for."""
    if isinstance(scorer, type):
        raise PrunusError(f"scorer: the class {scorer.__name__}; expected an object of it")
    missing = [name for name in ("name", "floor", "__call__") if not hasattr(scorer, name)]
    if missing:
        kind, lacks = type(scorer).__name__, ", no ".join(missing)
        raise PrunusError(f"scorer: {kind} has no {lacks}; expected an EdgeScorer")
    if not isinstance(scorer.name, str):
        raise PrunusError(f"scorer: its name is {scorer.name!r}; expected text")
    floor = frozen(scorer.floor, np.float64, (), f"scorer {scorer.name!r}: floor")
    if not 0 <= floor < 1:
        raise PrunusError(f"scorer {scorer.name!r}: floor {floor}; expected 0 to less than 1")


def score_edges(candidates: CandidateGraph, scorer: EdgeScorer) -> ScoredGraph:
    """The candidates with the confidence that the scorer gives.

    Raises PrunusError naming the scorer where that is no confidence: the search trusts it.
    """
    size, name = len(candidates.edges), _who(scorer)
    if not isinstance(scorer, CategoryScorer):
        confidence = _shares(f"{name}: confidence", scorer(candidates), (size,))
        return ScoredGraph.of_confidence(candidates, confidence, scorer.name)
    told = scorer.judge(candidates)
    if not isinstance(told, tuple) or len(told) != 2:
        raise PrunusError(f"{name}: judge gave {type(told).__name__}; expected two arrays")
    confidence = _shares(f"{name}: confidence", told[0], (size,))
    category = _shares(f"{name}: category", told[1], (size, CATEGORIES))
    if not (np.abs(category.sum(axis=1) - 1) < SUM_ERROR).all():
        raise PrunusError(f"{name}: category: not all rows sum to 1; expected probabilities")
    return ScoredGraph(candidates, confidence, category, scorer.name)


CATEGORIES = len(Label) + 1
"""Trunk, support, leader, side branch, other wood."""
SUM_ERROR = 0.01
"""Probabilities in single, or half, precision sum to 1 but for so much."""


def _shares(name: str, values: Any, shape: Shape) -> Floats:
    """Numbers in [0, 1] of that shape: beyond, a way costs less than nothing, and has no end."""
    found: Floats = frozen(values, np.float64, shape, name)
    bad = ~((found >= 0) & (found <= 1))
    if bad.any():
        raise PrunusError(f"{name}: holds {found[bad][0]:.9g}; expected numbers from 0 to 1")
    return found


def _who(scorer: EdgeScorer) -> str:
    """A scorer by its file, where it has one."""
    return str(getattr(scorer, "path", f"scorer {scorer.name!r}"))


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
