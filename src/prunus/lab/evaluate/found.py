"""Branch measures: what was found of a true tree and where it hangs (docs/evaluation.md).

Nothing here is counted twice: one predicted branch finds one true branch at most.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from prunus.lab.evaluate.compared import Side, compared, one_to_one, overlap
from prunus.lab.evaluate.seen import COUNTS
from prunus.model import Floats, Ints, Label, Skeleton
from prunus.model.arrays import GRID

ON_ONE = 0.7
"""Of what was met of a true branch, one predicted branch holds so large a share."""
FALSE_BELOW = 0.5
"""A predicted branch with less than this share near true ones of its label is false."""
OUTSET = 0.30
"""The direction of a support is that of its first so many metres."""
ASIDE = math.radians(45)
"""Two supports go the same way when their directions differ by less, radians."""


@dataclass(frozen=True, kw_only=True)
class Asked:
    """What is asked of a label: the share to meet of a true one, metres of a predicted one."""

    label: Label
    plural: str
    met: float
    judged_from: float


ASKED = (
    Asked(label=Label.LEADER, plural="leaders", met=0.80, judged_from=0.20),
    Asked(label=Label.SIDE_BRANCH, plural="side_branches", met=0.50, judged_from=0.08),
)


def branch_measures(predicted: Skeleton, truth: Skeleton) -> dict[str, float]:
    """Counts and shares of the branches found, of their parents and of the supports; base error.

    Both skeletons in one frame. For `leaders` and `side_branches`: `_true` (of 10 cm or more),
    `_found`, `_found_share`, `_predicted` (all), `false_`, and `_parents_right` of the found.
    `parents_right_share` is of all that was found. `supports_true`, `_predicted` and `_right` are
    those that leave the trunk. `base_error` is in metres. A share of nothing is NaN.
    """
    ours, theirs = compared(predicted, truth)
    measures = {}
    found, right = 0, 0
    for asked in ASKED:
        name = asked.plural
        pairs = _found(ours, theirs, asked)
        hung = _hung_right(ours, theirs, pairs)
        true = len(_long(theirs, asked.label))
        measures[f"{name}_true"] = float(true)
        measures[f"{name}_found"] = float(len(pairs))
        measures[f"{name}_found_share"] = _share(len(pairs), true)
        measures[f"{name}_predicted"] = float(sum(b.label == asked.label for b in ours.branches))
        measures[f"false_{name}"] = float(_false(ours, asked))
        measures[f"{name}_parents_right"] = float(hung)
        found, right = found + len(pairs), right + hung
    measures["parents_right_share"] = _share(right, found)
    measures |= _supports(ours, theirs)
    measures["base_error"] = float(np.linalg.norm(predicted.xyz[0] - truth.xyz[0]))
    return measures


def _long(side: Side, label: Label, length: float = COUNTS) -> Ints:
    """The branches of that label and at least that length, metres."""
    return np.flatnonzero([b.label == label and b.length >= length - GRID for b in side.branches])


def _found(ours: Side, theirs: Side, asked: Asked) -> list[tuple[int, int]]:
    """True branches that were found, each with the predicted one that found it.

    The share met of the true branch is taken over predicted branches of its label together;
    `ON_ONE` of that is near a single one, and that one finds no other. Where several could, those
    that overlap most go together.
    """
    true = _long(theirs, asked.label)
    met = theirs.met[true] / theirs.samples[true] >= asked.met
    on_one = theirs.shared[true] / np.maximum(theirs.met[true], 1)[:, None] >= ON_ONE
    fits = met[:, None] & on_one
    pairs = one_to_one(np.where(fits, overlap(ours, theirs)[true], 0))
    return [(int(true[first]), second) for first, second in pairs]


def _false(ours: Side, asked: Asked) -> int:
    """Predicted branches long enough to judge, with little of them near any true one."""
    judged = _long(ours, asked.label, asked.judged_from)
    return int((ours.met[judged] / ours.samples[judged] < FALSE_BELOW).sum())


def _hung_right(ours: Side, theirs: Side, pairs: list[tuple[int, int]]) -> int:
    """Found branches that leave the right parent: one that stands for the true parent.

    A predicted branch stands for the true one of its label that it overlaps most, whether or not
    that one was found: a leader in two pieces is the right parent with either.
    """
    both = overlap(ours, theirs)
    return sum(bool(stands_for(both, ours.parent[q]) == theirs.parent[t]) for t, q in pairs)


def stands_for(both: Ints, branch: int) -> int:
    """The true branch for which a predicted one stands; -1 for the base, -2 for none."""
    if branch < 0:
        return -1
    best = int(both[:, branch].argmax())
    return best if both[best, branch] else -2


def _supports(ours: Side, theirs: Side) -> dict[str, float]:
    """Supports of 10 cm or more that leave the trunk; right are those with one that goes along."""
    true, predicted = _directions(theirs), _directions(ours)
    cosine = true @ predicted.T
    right = len(one_to_one(np.where(cosine > math.cos(ASIDE), cosine, 0)))
    return {
        "supports_true": float(len(true)),
        "supports_predicted": float(len(predicted)),
        "supports_right": float(right),
        "supports_right_share": _share(right, len(true)),
    }


def _directions(side: Side) -> Floats:
    """Unit vectors (B, 3) along the first `OUTSET` of the supports that leave the trunk."""
    tree = side.skeleton
    ways = [np.zeros((0, 3))]
    for number in _long(side, Label.SUPPORT):
        rows = side.branches[number].rows
        if tree.label[rows[0]] == Label.TRUNK:
            along = np.concatenate([[0], tree.lengths[rows[1:]].cumsum()])
            point = [np.interp(OUTSET, along, tree.xyz[rows, axis]) for axis in range(3)]
            way = np.asarray(point) - tree.xyz[rows[0]]
            ways.append(way[None] / max(float(np.linalg.norm(way)), GRID))
    return np.concatenate(ways)


def _share(part: int, whole: int) -> float:
    return part / whole if whole else math.nan
