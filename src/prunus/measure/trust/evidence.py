"""What is known of each branch and each edge of a skeleton: by network, score, shape and points."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from prunus.measure.branches import Branch, branches
from prunus.measure.cuts.limbs import Limb, Limbs
from prunus.measure.refine import Refined
from prunus.model import Floats, Ints, Skeleton

LEAST = 0.02
"""Probabilities below are taken for it."""
SHORT = 0.05
"""What is shorter counts as so long, metres, where something is taken by the metre."""
FAR = 0.30
"""A tip farther from all else is no better, metres."""
TINY = 1e-9


@dataclass(frozen=True, eq=False)
class Known:
    """A skeleton in the house frame and all that is known of it.

    `fine` is the same refined; gain, likely (M, L) what each edge brings under each label, and how
    likely that is by the network (`search.judged`); `raw`: it was taken out of a raw scan.
    """

    skeleton: Skeleton
    fine: Refined
    gain: Floats
    likely: Floats
    raw: bool


Evidence = dict[str, float]


def of_branches(known: Known) -> list[Evidence]:
    """The evidence of each branch, in the order of `measure.branches`.

    Of its edges: `least`, the logarithm of the least confidence; `kind`, the mean logarithm, by
    length, of how likely its label is; `rival`, how much more it brings, a metre, under its label
    than under the next best. Of its shape: `length`, logarithm of metres; `straight`, from foot to
    tip over that; `bend`, logarithm of the degrees at its foot; `touch`, metres from its tip to
    the nearest other branch. `seen`, the share with points; `raw`, 1 in a tree of a raw scan.
    """
    limbs = Limbs.of(known.fine.skeleton, known.fine.names).all
    found = branches(known.skeleton)
    return [_of_branch(known, *pair) for pair in zip(found, limbs, strict=True)]


def _of_branch(known: Known, branch: Branch, limb: Limb) -> Evidence:
    skeleton, rows, label = known.skeleton, branch.rows[1:], int(branch.label)
    weight = skeleton.lengths[rows] + TINY
    brings = known.gain[rows].sum(axis=0)
    beeline = float(np.linalg.norm(skeleton.xyz[rows[-1]] - skeleton.xyz[branch.rows[0]]))
    return {
        "least": float(_log(skeleton.confidence[rows].min())),
        "kind": float(np.average(_log(known.likely[rows, label]), weights=weight)),
        "rival": float(brings[label] - np.delete(brings, label).max()) / max(branch.length, SHORT),
        "length": math.log(max(branch.length, LEAST)),
        "straight": beeline / max(branch.length, TINY),
        "bend": math.log(max(limb.bend, 2.0)),
        "touch": _touch(skeleton, branch.rows),
        "seen": known.fine.seen_share(limb.rows[1:]),
        "raw": float(known.raw),
    }


def of_edges(known: Known, branch_trust: Floats) -> list[Evidence]:
    """The evidence of each edge (M - 1,), given the probability that each branch (B,) is right.

    `edge`, `kind`: logarithms of its confidence and of how likely its label is; `branch`: the log
    odds of its branch, `whole` the logarithm of that one's length; `length`, metres; `foot`, `tip`:
    1 for the first and the last edge of a branch.
    """
    skeleton = known.skeleton
    sure = branch_trust.clip(TINY, 1 - TINY)
    odds = np.log(sure / (1 - sure)).clip(-MOST, MOST)
    found: dict[int, Evidence] = {}
    for number, branch in enumerate(branches(skeleton)):
        for row in branch.rows[1:].tolist():
            found[row] = {
                "edge": float(_log(skeleton.confidence[row])),
                "kind": float(_log(known.likely[row, int(branch.label)])),
                "branch": float(odds[number]),
                "whole": math.log(max(branch.length, LEAST)),
                "length": float(skeleton.lengths[row]),
                "foot": float(row == branch.rows[1]),
                "tip": float(row == branch.rows[-1]),
            }
    return [found[row] for row in range(1, len(skeleton))]


MOST = 4.0
"""Log odds of a branch are no farther from even."""


def _touch(skeleton: Skeleton, rows: Ints) -> float:
    """How near the tip of a branch is to a node of another, metres."""
    others = np.delete(skeleton.xyz, rows, axis=0)
    if len(others) == 0:
        return FAR
    return min(float(np.linalg.norm(others - skeleton.xyz[rows[-1]], axis=1).min()), FAR)


def _log(probability: Floats | float) -> Floats:
    return np.asarray(np.log(np.clip(probability, LEAST, 1.0)))
