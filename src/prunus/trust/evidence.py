"""What is known of the branches and edges of a tree that grew on the votes of a point field."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from prunus.geometry.vectors import unit
from prunus.model import Bools, Floats, Ints, Role, Skeleton, Told
from prunus.model.branches import Branch, branch_of_rows, branches
from prunus.model.role import label_chances

Evidence = dict[str, float]
LEAST = 0.02
"""Probabilities below are taken for it."""
TINY = 1e-9
MOST = 4.0
"""Log odds of a branch are no farther from even."""

THIN_M = 0.001
"""No branch is thinner."""
BESIDE_M = 0.05
"""Another branch that runs so near to one is beside it,"""
ALONG_COS = 0.7
"""where the cosine between their directions is at least this."""


@dataclass(frozen=True, eq=False)
class Known:
    """A grown tree in the house frame and what the field told of it."""

    skeleton: Skeleton
    told: Told


def of_branches(known: Known, form: float) -> list[Evidence]:
    """The evidence of each branch, in the order of `branches`.

    `form`: how likely the tree is of the training form of its labels; of others less is asked.
    Logarithms of probabilities: `least` and `mean` of its edges' confidence, `kind` of its label
    in the mean, `wood` of its being wood, `way` the least confidence on the way from the base to
    it; `rival`, how much more likely its label is than the next.
    Of its shape: `length` and `thick`, logarithms of metres and of its radius over its parent's;
    `straight`, from foot to tip over its length; `beside`, the share along which another branch
    runs. `scatter`, of its votes, centimetres. Of the whole tree: `explained`.
    """
    skeleton = known.skeleton
    found = branches(skeleton)
    owner = branch_of_rows(found, len(skeleton))
    chance, beside = _log(label_chances(known.told.role)), _beside(skeleton, owner)
    way = _least_on_the_way(skeleton)
    return [_of_branch(known, branch, chance, beside, way) | {"form": form} for branch in found]


def _of_branch(
    known: Known, branch: Branch, chance: Floats, beside: Bools, way: Floats
) -> Evidence:
    skeleton, told, rows, foot = known.skeleton, known.told, branch.rows[1:], int(branch.rows[0])
    weight = skeleton.lengths[rows] + TINY

    def mean(values: Floats | Bools) -> float:
        return float(np.average(values, weights=weight))

    sure, kind = _log(skeleton.confidence[rows]), [mean(column) for column in chance[rows].T]
    beeline = float(np.linalg.norm(skeleton.xyz[rows[-1]] - skeleton.xyz[foot]))
    return {
        "least": float(sure.min()),
        "mean": mean(sure),
        "kind": kind[branch.label],
        "rival": kind[branch.label] - max(np.delete(kind, branch.label)),
        "wood": mean(_log(1 - told.role[rows, Role.NO_WOOD])),
        "way": float(way[foot]),
        "length": math.log(max(branch.length, LEAST)),
        "thick": math.log(max(mean(skeleton.radius[rows]), THIN_M)
                          / max(float(skeleton.radius[foot]), THIN_M)),
        "straight": beeline / max(branch.length, TINY),
        "beside": mean(beside[rows]),
        "scatter": 100 * mean(told.scatter[rows]),
        "explained": told.whole["explained"],
    }  # fmt: skip


def of_edges(known: Known, branch_trust: Floats, form: float) -> list[Evidence]:
    """The evidence of each edge (M - 1,), given the probability that each branch (B,) is right.

    Logarithms: `edge` of its confidence, `kind` of how likely its label is, `whole` of the length
    of its branch; `branch`: the log odds of that; `beside`: whether another runs beside it.
    """
    skeleton = known.skeleton
    found = branches(skeleton)
    owner = branch_of_rows(found, len(skeleton))
    beside = _beside(skeleton, owner)
    sure = branch_trust.clip(TINY, 1 - TINY)
    odds = np.log(sure / (1 - sure)).clip(-MOST, MOST)
    whole = np.log(np.maximum([branch.length for branch in found], LEAST))
    row = np.arange(1, len(skeleton))
    table = np.column_stack([
        _log(skeleton.confidence[row]),
        _log(label_chances(known.told.role)[row, skeleton.label[row]]),
        odds[owner[row]], whole[owner[row]], beside[row], np.full(len(row), form),
    ])  # fmt: skip
    names = ("edge", "kind", "branch", "whole", "beside", "form")
    return [dict(zip(names, values, strict=True)) for values in table.tolist()]


def of_tree(known: Known) -> Evidence:
    """The evidence in the tree as a whole.

    What the field told (`growth.told`), and, in the mean over its length, `sure`, its confidence,
    `kind`, the logarithm of how likely its labels are, and how likely it is framework, `frame`, or
    fruiting unit, `fruit`.
    """
    skeleton, row = known.skeleton, np.arange(1, len(known.skeleton))
    weight = skeleton.lengths[1:] + TINY
    kind = _log(label_chances(known.told.role)[row, skeleton.label[row]])
    return {
        **known.told.whole,
        "sure": float(np.average(skeleton.confidence[1:], weights=weight)),
        "kind": float(np.average(kind, weights=weight)),
        "frame": float(np.average(known.told.role[1:, Role.FRAMEWORK], weights=weight)),
        "fruit": float(np.average(known.told.role[1:, Role.FRUITING_UNIT], weights=weight)),
    }


def _beside(skeleton: Skeleton, owner: Ints) -> Bools:
    """Along which rows (M,) another branch runs beside their own."""
    way = unit(skeleton.xyz - skeleton.xyz[np.maximum(skeleton.parent, 0)])
    one, other = cKDTree(skeleton.xyz).query_pairs(BESIDE_M, output_type="ndarray").T
    along = np.abs((way[one] * way[other]).sum(axis=1)) > ALONG_COS
    beside = np.zeros(len(skeleton), np.bool_)
    beside[np.stack([one, other])[:, along & (owner[one] != owner[other])]] = True
    return beside


def _least_on_the_way(skeleton: Skeleton) -> Floats:
    """The logarithm (M,) of the least confidence on the way from the base to each row."""
    least = _log(np.nan_to_num(skeleton.confidence, nan=1.0))
    for row, above in enumerate(skeleton.parent.tolist()):
        if above >= 0:
            least[row] = min(least[row], least[above])
    return least


def _log(probability: Floats) -> Floats:
    return np.asarray(np.log(np.clip(probability, LEAST, 1.0)))
