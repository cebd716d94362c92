"""What a person should know before acting on a skeleton, in plain words."""

from __future__ import annotations

import numpy as np

from prunus.model import Label, SeededGraph, Skeleton
from prunus.model.branches import branches

UNEXPLAINED = 0.10
"""A larger share of points that no branch passes is worth a remark."""
SHORT = 0.30
"""A support that ends so many metres before the scan is worth a remark."""


def remarks(skeleton: Skeleton, graph: SeededGraph, for_tips: bool = True) -> list[str]:
    """Remarks on a skeleton in the house frame, the most important first; often none.

    `for_tips`: the search went for the tips, so that one that was not reached is worth a remark.
    """
    found = []
    for label in (Label.SUPPORT, Label.LEADER):
        if not skeleton.edges_with(label).any():
            found.append(f"no {label.word} was found")
    unexplained = 1 - explained_points(skeleton, graph)
    if unexplained > UNEXPLAINED:
        found.append(f"{unexplained:.0%} of the points are not explained by any branch")
    missed = int((~np.isin(graph.tips, skeleton.superpoint)).sum())
    if missed and for_tips:
        found.append(f"{missed} of {len(graph.tips)} tips were not reached")
    return found + _short_supports(skeleton, graph)


def explained_points(skeleton: Skeleton, graph: SeededGraph) -> float:
    """Share of the points within r_super of a superpoint of the skeleton."""
    near = graph.superpoints.points_near(skeleton.superpoint[skeleton.superpoint >= 0])
    return float(near.mean())


def _short_supports(skeleton: Skeleton, graph: SeededGraph) -> list[str]:
    """Sides to which a support grows and where even the longest ends before the scan does."""
    ends = [np.quantile(graph.superpoints.cloud.xyz[:, 0], share) for share in (0.005, 0.995)]
    x = skeleton.xyz[:, 0]
    rest: dict[int, float] = {}
    for branch in branches(skeleton, Label.SUPPORT):
        side = int(x[branch.rows[-1]] > x[branch.rows[0]])
        short = abs(float(ends[side] - x[branch.rows[-1]]))
        rest[side] = min(short, rest.get(side, short))
    return [
        f"the {('left', 'right')[side]} support ends {short:.1f} m before the scan does"
        for side, short in sorted(rest.items())
        if short > SHORT
    ]
