"""What the chain gives: the skeleton, the evidence, and what is asked of both afterwards."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from prunus.model import Floats, Label, PointCloud, SeededGraph, Skeleton, Told
from prunus.model.branches import branches
from prunus.model.isolated import Isolated
from prunus.params import Parameters
from prunus.refine.refined import Refined, refined
from prunus.trust import Known, Trust, trust_in
from prunus.trust.review import review_of

REFINED_WITH = 150_000
"""So many points of the tree, drawn at random, are enough to refine its skeleton."""

Seconds = dict[str, tuple[float, float]]
"""CPU and wall seconds of each stage."""


@contextmanager
def timed(seconds: Seconds, stage: str) -> Iterator[None]:
    """Add the time that is spent inside to that of a stage."""
    cpu, wall = time.process_time(), time.perf_counter()
    yield
    before = seconds.get(stage, (0.0, 0.0))
    spent = time.process_time() - cpu, time.perf_counter() - wall
    seconds[stage] = (before[0] + spent[0], before[1] + spent[1])


@dataclass(frozen=True, eq=False, kw_only=True)
class Found:
    """What a method makes of a cloud: see the fields of `Result` of the same names."""

    skeleton: Skeleton
    graph: SeededGraph
    warnings: list[str]
    notes: list[str]
    isolated: Isolated | None
    told: Told | None = None
    score: float | None = None
    history: Floats = field(default_factory=lambda: np.zeros(0))


@dataclass(frozen=True, eq=False, kw_only=True)
class Result:
    """The skeleton and the evidence: graph, score, history (I,) of best scores, timings, warnings.

    The score is None, and the history empty, where the method goes by none.
    `in_house` is the skeleton in the house frame (Z up); `skeleton` in the frame of the input.
    `scan` is all that was given; `isolated` what each point of it is, where it was a raw scan;
    `told` what the point field told, where the tree grew on its votes.
    """

    in_house: Skeleton
    graph: SeededGraph
    score: float | None
    history: Floats
    seconds: Seconds
    params: Parameters
    seed: int
    warnings: list[str]
    notes: list[str]
    scan: PointCloud
    isolated: Isolated | None
    told: Told | None = None

    def __repr__(self) -> str:
        leaders, sides = (
            len(branches(self.in_house, label)) for label in (Label.LEADER, Label.SIDE_BRANCH)
        )
        trust = "unknown" if self.trust is None else f"{self.trust.tree:.2f}"
        return f"Result({leaders} leaders, {sides} side branches, trust {trust})"

    @cached_property
    def skeleton(self) -> Skeleton:
        """The skeleton in the frame of the input, with the radii of the refined one."""
        radius = self.refined.radius_at(self.in_house.superpoint)
        back = self.graph.superpoints.cloud.to_input
        return self.in_house.with_radius(radius).moved(back)

    @cached_property
    def tree_cloud(self) -> PointCloud:
        """All points of the tree: what was given, or what was isolated of it."""
        if self.isolated is None:
            return self.scan
        return self.scan.take(self.isolated.target)

    @cached_property
    def refined(self) -> Refined:
        """The skeleton refitted to these points, in the house frame; made when first asked for."""
        points = self.tree_cloud.sample(REFINED_WITH, np.random.default_rng(self.seed))
        likely = None if self.trust is None else self.trust.of_rows(self.in_house)
        return refined(self.in_house, points, likely)

    @cached_property
    def trust(self) -> Trust | None:
        """How far to trust it; None where it did not grow on votes."""
        if len(self.in_house) == 1 or self.told is None:
            return None
        return trust_in(Known(self.in_house, self.told))

    @cached_property
    def review(self) -> list[str]:
        """Why a person should look at the tree before a machine acts on it; empty: no need."""
        doubts = [] if self.trust is None else review_of(self.in_house, self.trust)
        return [*self.warnings, *doubts]
