"""Confidence one can act on: how likely each edge, each branch and the tree is right.

A branch is right where it is one true branch of its label and hangs on the right one
(`lab/evaluate/right.py`); an edge, where a person who corrects the skeleton would leave it as it
is. The network's confidence says of an edge alone whether wood joins two places; this says whether
the skeleton is right there. Calibrated on simulated trees: docs/trust.md.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from prunus.model import Floats, Skeleton
from prunus.model.branches import branch_of_rows, branches
from prunus.trust.evidence import Known, of_branches, of_edges, of_tree
from prunus.trust.model import WHOLE, Model, Parts, shipped_model

__all__ = ["Known", "Model", "Parts", "Trust", "shipped_model", "trust_in"]

WOOD = 0.60
"""What is less likely a bare tree lowers all trust, and is said."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Trust:
    """How likely a skeleton is right.

    edge (M,): the edge into each row needs no correction, NaN at row 0; branch (B,): the branch is
    right, in the order of `branches`; tree: the share of its edges, by their number, that
    need no correction. Each how likely: `meant`, that no other in view is the tree that is meant;
    `wood`, that it is a bare tree at all; `form`, that it is trained as its labels have it. The
    first counts in all trust, the second where it is low; where the third is, trust is in the
    geometry: that an edge lies on wood, and a branch on one.
    """

    edge: Floats
    branch: Floats
    tree: float
    meant: float = 1.0
    wood: float = 1.0
    form: float = 1.0

    @property
    def whole(self) -> float:
        """How likely it is the tree that is meant, lowered where it is likely none."""
        return self.meant * min(1.0, self.wood / WOOD)

    def of_rows(self, skeleton: Skeleton) -> Floats:
        """How likely the branch of each row (M,) of that skeleton is right."""
        return self.branch[branch_of_rows(branches(skeleton), len(skeleton))]


def trust_in(known: Known, model: Model | None = None) -> Trust:
    """How far to trust a skeleton, by all that is known of it."""
    model = model or shipped_model()
    evidence = of_tree(known)
    meant, wood, form = (model.whole[name](evidence) for name in WHOLE)
    found = branches(known.skeleton)
    told = zip(found, of_branches(known, form), strict=True)
    branch = np.array([model.parts.branch[one.label](said) for one, said in told])
    edge = np.array([np.nan, *map(model.parts.edge, of_edges(known, branch, form))])
    own = Trust(
        edge=edge, branch=branch, tree=float(np.nanmean(edge)), meant=meant, wood=wood, form=form
    )
    sure = own.whole
    return replace(own, edge=sure * edge, branch=sure * branch, tree=sure * own.tree)
