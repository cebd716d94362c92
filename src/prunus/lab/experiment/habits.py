"""What is difficult about a tree, read off its true skeleton."""

from __future__ import annotations

import numpy as np

from prunus.geometry.near import within
from prunus.model import Floats, Label, Skeleton
from prunus.model.branches import Branch, branches

LEVEL = 0.30
"""A leader runs sideways that goes level for so many metres before it rises."""
CLIMB = 15.0
"""A support climbs by so many degrees from end to end."""
BESIDE, STRETCH = 0.10, 0.20
"""Two leaders are close that keep within so many metres of each other for so many."""
FOOT = 0.30
"""So much of a leader, metres, is near others because it leaves near them."""
SHOOT = 0.50
"""A shoot of so many metres on trunk or support looks like a leader."""


def habits_of(truth: Skeleton) -> tuple[str, ...]:
    """The names of the habits that a true tree has."""
    leaders = branches(truth, Label.LEADER)
    supports = branches(truth, Label.SUPPORT)
    shoots = [
        branch
        for branch in branches(truth, Label.SIDE_BRANCH)
        if truth.label[branch.rows[0]] <= Label.SUPPORT and branch.length >= SHOOT
    ]
    forks = [branch for branch in leaders if truth.label[branch.rows[0]] == Label.LEADER]
    found = {
        "one arm": len(supports) == 1,
        "climbing support": any(_climb(truth, branch) >= CLIMB for branch in supports),
        "sideways leader": any(_level(truth, branch) >= LEVEL for branch in leaders),
        "leaders close or crossing": _close([truth.xyz[leader.rows] for leader in leaders]),
        "tall shoots": bool(shoots),
        "forked leader": bool(forks),
    }
    return tuple(name for name, has in found.items() if has)


HABITS = (
    "one arm", "climbing support", "sideways leader", "leaders close or crossing", "tall shoots",
    "forked leader",
)  # fmt: skip


def _climb(truth: Skeleton, branch: Branch) -> float:
    """Degrees by which a branch climbs from end to end."""
    chord = truth.xyz[branch.rows[-1]] - truth.xyz[branch.rows[0]]
    return float(np.degrees(np.arctan2(chord[2], np.hypot(chord[0], chord[1]))))


def _level(truth: Skeleton, branch: Branch) -> float:
    """Metres that a branch goes before it first rises steeper than 45 degrees."""
    rows = branch.rows[1:]
    steep = truth.edge_vectors[rows, 2] > np.sqrt(0.5) * truth.lengths[rows]
    level = rows[: int(steep.argmax())] if steep.any() else rows
    return float(truth.lengths[level].sum())


def _close(lines: list[Floats]) -> bool:
    """Whether any two of some lines (Q, 3), without their feet, keep beside each other."""
    upper = []
    for line in lines:
        steps = np.linalg.norm(np.diff(line, axis=0), axis=1)
        upper.append((line[1:][steps.cumsum() > FOOT], steps[steps.cumsum() > FOOT]))
    for i, (one, lengths) in enumerate(upper):
        for j, (other, _) in enumerate(upper):
            if i != j and len(one) and len(other):
                near = np.diff(within(other, one, BESIDE)[0]) > 0
                if lengths[near].sum() >= STRETCH:
                    return True
    return False
