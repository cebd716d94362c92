"""Whether what the chain found can be a tree: the one place that says so.

A skeleton of almost nothing, or of what is no wood, is a failure and not an answer.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from prunus.errors import NoTreeError
from prunus.frames.diagnosis import (
    LINE_M,
    STEP_M,
    coarse_words,
    coarseness,
    frame_by_evidence,
    spread,
)
from prunus.frames.linear import linear_at, linear_of
from prunus.frames.upright import sureness, sureness_in, sureness_of
from prunus.model import Label, PointCloud, Skeleton
from prunus.model.remarks import explained_points
from prunus.paper.trunks import find_trunks
from prunus.result import Result

# The limits were set on simulated and drawn clouds alone, by `python -m bench.plausible`: 142 scans
# of 40 trees, on 130 of which wood could be followed, 36 of them raw with nothing taken out; 22
# trees laid on their sides; and 52 clouds of 13 kinds of what is no tree.
LEAST_LENGTH_M = 0.50
"""A tree has so much wood: 0.92 m at least on the 130; 0.46 m at most was found on poles and bare
trellises, and in the twelve scans that were too sparse."""
MOST_STEP_M = 0.05
"""In larger steps coordinates tell nothing: of six trees whose coordinates were rounded all were
found at 4 cm, and none at 6."""
LEAST_EXPLAINED = 0.10
"""A skeleton passes so large a share of the points: 0.23 at least on the 94 that are one tree
or were made one, 0.14 on the 36 but for one with 0.05; 0.09 at most where no wood was followed."""
MOST_EXPLAINED = 0.50
"""Where it passes less, as on 4 of the 94 and 21 of the 36, a hedge or a heap of twigs is told by
there being no trunk in view."""
LEAST_LINEAR, USUAL_LINEAR = 0.30, 0.40
"""On the 130 none had less than 0.38 (see `Evidence`); walls, balls and boxes had 0.07 to 0.28,
what else is a surface up to 0.35."""
LEAST_WOOD, LEAST_SURE = 0.10, 0.26
"""What grew on votes is so likely a bare tree, and so sure in the mean. Wood: 0.42 at least on 20
scans of any tree (`bench.set_cases`), 0.11 on whole rows taken for one tree; 0.0 to 0.09 on walls,
balls, boxes and cones of needles. Sure: 0.38 at least, 0.31 where coordinates come in steps of 4
cm; 0.14 to 0.23 on walls, noise, leaves and twigs of 10 cm."""
USUAL_RISE = 0.45
"""Leaders rise so much a metre of their length: 0.51 at least on the 130, less than this on 11 of
the 22 that lie."""
USUAL_FORM, USUAL_WOOD, UPRIGHT_RISE = 0.90, 0.90, 0.60
"""Where form or wood is less likely, or leaders rise less, it is looked whether the tree lies."""
LYING_SURER = 0.015
"""A tree lies where it is so much surer in another frame (`frames.upright.sureness`)."""


@dataclass(frozen=True, kw_only=True)
class Evidence:
    """What tells a tree from what is none.

    length: metres of skeleton; across: how far its points are off one line, metres; explained: the
    share of them within r_super of it; linear: how much the median superpoint (of a tree that grew
    on votes, the median place of its cloud) looks like a piece of a branch, 0 to 1; rise: metres up
    a metre of leader; step: in which the coordinates come, metres. Of a scorer that tells
    categories: trunk, whether one is in view. Of a tree that grew on votes in place of it: wood,
    how likely it is a bare tree; sure, the confidence of its edges in the mean over their length.
    lies: whether another axis than Z is up, by all evidence and by how sure the tree is then.
    """

    length: float
    across: float
    explained: float
    linear: float
    rise: float
    step: float = 0.0
    trunk: bool = True
    wood: float = 1.0
    sure: float = 1.0
    lies: bool = False

    @classmethod
    def of(cls, result: Result) -> Evidence:
        """The evidence in what the chain found."""
        skeleton, graph = result.in_house, result.graph
        length, explained = float(skeleton.lengths.sum()), explained_points(skeleton, graph)
        trunk, wood, sure = True, 1.0, 1.0
        if result.told is None:
            linear = linear_at(graph.superpoints)
            trunk = not graph.scored.category.size or bool(find_trunks(graph.scored))
        else:
            linear = linear_of(graph.superpoints.cloud.xyz)
            sure = sureness(skeleton)
            wood = 1.0 if result.trust is None else result.trust.wood
        across = float(spread(graph.superpoints.cloud.xyz)[1])
        rise, step = rise_of_leaders(skeleton), coarseness(result.scan)
        form = 1.0 if result.trust is None else result.trust.form
        odd = form < USUAL_FORM or wood < USUAL_WOOD or 0 < rise < UPRIGHT_RISE
        lying = odd and lies(result.scan)
        return cls(
            length=length,
            across=across,
            explained=explained,
            linear=linear,
            rise=rise,
            step=step,
            trunk=trunk,
            wood=wood,
            sure=sure,
            lies=lying,
        )

    def check(self) -> None:
        """Raise NoTreeError where it is no tree."""
        for reason in self._against():
            raise NoTreeError(f"no tree was found{reason}")

    def _against(self) -> Iterator[str]:
        heap = f", but a hedge or a heap of twigs: {1 - self.explained:.0%} of the points are not"
        faults = (
            (self.length == 0, ": no wood can be followed from its base"),
            (self.length < LEAST_LENGTH_M,
             f": {self.length:.2f} m of wood; expected at least {LEAST_LENGTH_M:g} m"),
            (self.step >= MOST_STEP_M, ""),
            (self.across < LINE_M, ", but a straight line"),
            (self.linear < LEAST_LINEAR, ", but a surface or a heap"),
            (self.sure < LEAST_SURE, ", but a heap: what was followed is not like branches"),
            (self.wood < LEAST_WOOD,
             f", but what is {self.wood:.0%} likely bare wood: a surface, a heap or leaves"),
            (self.explained < LEAST_EXPLAINED,
             f": its branches explain {self.explained:.0%} of the points"),
            (not self.trunk and self.explained < MOST_EXPLAINED,
             f"{heap} explained by any branch, and no trunk is in view"),
            (self.lies, ", since it lies"),
        )  # fmt: skip
        return (text for wrong, text in faults if wrong)

    def doubts(self) -> list[str]:
        """Why it may be none."""
        found = []
        if self.step >= STEP_M:
            found.append(coarse_words(self.step))
        if self.linear < USUAL_LINEAR:
            found.append("much of the cloud is not like branches, but like surfaces or heaps")
        if not self.trunk:  # as on 16 of the 22 that lie, and on 2 of the 130
            found.append("no trunk is in view: is Z up (see --frame)?")
        if 0 < self.rise < USUAL_RISE:
            found.append(
                f"the leaders hardly rise ({self.rise:.1f} m a metre): is Z up (see --frame)?"
            )
        return found


def lies(cloud: PointCloud) -> bool:
    """Whether a tree is surer in another frame, for which all evidence in its cloud is.

    None of 154 scans of standing trees was told to lie (other forms, rows and measured trees too);
    of 20 clouds of lying ones all were, and were surer by 0.026 at least.
    """
    frame = frame_by_evidence(cloud)
    if not frame:
        return False
    upright = sureness_in(cloud.to_input.apply(cloud.xyz), frame)
    return upright > sureness_of(cloud) + LYING_SURER


def rise_of_leaders(skeleton: Skeleton) -> float:
    """How much the leaders of a skeleton go up or down a metre of their length; 0: it has none."""
    leaders = skeleton.edges_with(Label.LEADER)
    length = skeleton.lengths[leaders].sum()
    return float(np.abs(skeleton.edge_vectors[leaders, 2]).sum() / length) if length else 0.0
