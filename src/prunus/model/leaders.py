"""Leaders: how tall, how far they lean, how far apart they stand."""

from __future__ import annotations

import math
from dataclasses import dataclass

from prunus.model import Label, Skeleton
from prunus.model.branches import branches


@dataclass(frozen=True, kw_only=True)
class Leader:
    """One leader in the house frame, metres.

    `row` is its top; `x` the mean along the row; `lean` from the vertical, degrees; `spacing`
    along X from the leader before it, NaN for the first.
    """

    row: int
    x: float
    length: float
    height: float
    lean: float
    spacing: float
    side_branches: int


def leaders(skeleton: Skeleton) -> list[Leader]:
    """The leaders of a skeleton in the house frame, by where they stand along the row."""
    carried = dict.fromkeys(range(len(skeleton)), 0)
    for branch in branches(skeleton, Label.SIDE_BRANCH):
        carried[int(branch.rows[0])] += 1
    found = []
    for branch in branches(skeleton, Label.LEADER):
        chord = skeleton.xyz[branch.rows[-1]] - skeleton.xyz[branch.rows[0]]
        upright = math.degrees(math.atan2(math.hypot(chord[0], chord[1]), chord[2]))
        middle = float(skeleton.xyz[branch.rows, 0].mean())
        shoots = sum(carried[int(row)] for row in branch.rows[1:])
        top = int(branch.rows[-1])
        found.append((middle, top, branch.length, float(chord[2]), upright, shoots))
    found.sort()
    before = [math.nan, *(leader[0] for leader in found)]
    return [
        Leader(
            row=top,
            x=x,
            length=length,
            height=height,
            lean=lean,
            spacing=x - left,
            side_branches=shoots,
        )
        for left, (x, top, length, height, lean, shoots) in zip(before, found, strict=False)
    ]
