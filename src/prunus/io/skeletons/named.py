"""The names of branches in files: refining moves branches, and a count anew would swap some."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import cast

from prunus.io.skeletons.skeleton_file import DIGITS, BranchName, Word
from prunus.model import Floats, Skeleton
from prunus.model.branch_names import branch_names
from prunus.model.branches import branches


def names_of(skeleton: Skeleton, named: Mapping[int, str]) -> list[str]:
    """The name of each branch: as told of the node after its first, else by a count along X."""
    found = branches(skeleton)
    counted = zip(found, branch_names(skeleton, found), strict=True)
    return [named.get(int(branch.rows[1]), name) for branch, name in counted]


def named_branches(skeleton: Skeleton, names: Iterable[str], likely: Floats) -> list[BranchName]:
    """All branches of a skeleton, as `refined.json` has them; `likely` (M,): that each is right."""
    return [
        BranchName(
            number=number,
            name=name,
            label=cast(Word, branch.label.word),
            nodes=branch.rows.tolist(),
            trust=_known(likely[branch.rows[1]]),
        )
        for number, (name, branch) in enumerate(zip(names, branches(skeleton), strict=True))
    ]


def _known(likely: float) -> float | None:
    return round(float(likely), DIGITS) if math.isfinite(likely) else None
