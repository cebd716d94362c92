"""Edge confidence through replaceable scorers (sec. Edge evaluation)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from prunus.kernels.frames import HIGH, WIDE
from prunus.model import CandidateGraph, Floats, ScoredGraph
from prunus.stages.images import edge_images


class EdgeScorer(Protocol):
    """Whoever gives each candidate edge a confidence (E,) in [0, 1]."""

    @property
    def name(self) -> str:
        """What reports call it."""

    def __call__(self, candidates: CandidateGraph) -> Floats:
        """Conf(e) for every candidate edge."""


def score_edges(candidates: CandidateGraph, scorer: EdgeScorer) -> ScoredGraph:
    """The graph with the confidence that the scorer gives."""
    return ScoredGraph(candidates, scorer(candidates), scorer.name)


@dataclass(frozen=True)
class ConstantScorer:
    """Every edge the same: the scorer that does nothing."""

    value: float = 1.0
    name: str = "constant"

    def __call__(self, candidates: CandidateGraph) -> Floats:
        """The constant (E,)."""
        return np.full(len(candidates.edges), self.value)


@dataclass(frozen=True)
class HandmadeScorer:
    """How evenly and how tightly the points fill the edge, and how well they line up with it."""

    name: str = "handmade"

    def __call__(self, candidates: CandidateGraph) -> Floats:
        """Confidence (E,): a logistic function of the features of the edge image."""
        vectors = candidates.xyz[candidates.edges[:, 1]] - candidates.xyz[candidates.edges[:, 0]]
        lengths = np.linalg.norm(vectors, axis=1) / candidates.superpoints.radius
        features = image_features(edge_images(candidates).astype(np.float64), lengths)
        return np.asarray(1 / (1 + np.exp(-(features @ WEIGHTS + OFFSET))))


def image_features(images: Floats, lengths: Floats) -> Floats:
    """Features (E, 4) of edge images (E, 16, 32), for edges of so many r_super (E,).

    gap: the longest empty run between the two ends, in r_super; evenness: the emptier fifth of
    the columns between the ends against their mean; looseness: root mean square distance of the
    points from the edge, in r_super; slant: slope of the points against the edge.
    """
    x = (np.arange(WIDE) + 0.5) * 4 / WIDE - 2
    y = (np.arange(HIGH) + 0.5) * 2 / HIGH - 1
    between = np.abs(x) <= np.maximum(lengths[:, None] / 2, 4 / WIDE)
    near = images[:, np.abs(y) < 0.4].sum(axis=1)
    mean = (near * between).sum(axis=1) / between.sum(axis=1)
    empty = between & (near < 0.1 * np.maximum(mean, 1e-9)[:, None])
    run, longest = np.zeros(len(images)), np.zeros(len(images))
    for column in range(WIDE):
        run = (run + 1) * empty[:, column]
        longest = np.maximum(longest, run)
    fill = np.where(between, near, np.nan)
    evenness = np.nanquantile(fill, 0.2, axis=1) / np.maximum(mean, 1e-9)
    inside = images * between[:, None, :]
    total = np.maximum(inside.sum(axis=(1, 2)), 1e-9)
    looseness = np.sqrt((inside * (y**2)[None, :, None]).sum(axis=(1, 2)) / total)
    moment = (inside * y[None, :, None] * x[None, None, :]).sum(axis=(1, 2))
    slant = np.abs(moment) / np.maximum((inside * (x**2)[None, None, :]).sum(axis=(1, 2)), 1e-9)
    return np.column_stack([longest * 4 / WIDE, evenness, looseness, slant])


WEIGHTS = np.array([-6.0, 2.0, -8.0, -3.0])
OFFSET = 4.5
