"""Confidence one can act on: how likely each edge, each branch and the tree is right.

A branch is right where it is one true branch of its label and hangs on the right one
(`evaluate.right`); an edge, where a person who corrects the skeleton would leave it as it is. The
network's confidence says of an edge alone whether wood joins two places; this says whether the
skeleton is right there. Calibrated on simulated trees: docs/trust.md.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from prunus.measure.branches import branches
from prunus.measure.trust.evidence import Known, of_branches, of_edges
from prunus.measure.trust.model import Model, shipped_model
from prunus.model import Floats

__all__ = ["Known", "Model", "Trust", "shipped_model", "trust_in"]


@dataclass(frozen=True, eq=False)
class Trust:
    """How likely a skeleton is right.

    edge (M,): the edge into each row needs no correction, NaN at row 0; branch (B,): the branch is
    right, in the order of `measure.branches`; tree: the share of its edges, by their number, that
    need no correction.
    """

    edge: Floats
    branch: Floats
    tree: float


def trust_in(known: Known, model: Model | None = None) -> Trust:
    """How far to trust a skeleton, by all that is known of it."""
    model = model or shipped_model()
    found = branches(known.skeleton)
    branch = np.array(
        [model.branch[one.label](told) for one, told in zip(found, of_branches(known), strict=True)]
    )
    edge = np.array([np.nan, *map(model.edge, of_edges(known, branch))])
    return Trust(edge, branch, float(np.nanmean(edge)) if len(edge) > 1 else 0.0)
