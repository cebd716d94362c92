"""Drop stubs: short leaders on the way to a tip that was then reached from elsewhere.

The search grows every edge towards some tip, but a branch may stop when its tip is reached by
another. In the paper's words the skeleton is the union of base-to-tip paths; what is neither a
path to a tip nor long enough to be a leader of its own is no leader.
"""

from __future__ import annotations

import numpy as np

from prunus.grammar import TIP_LABEL
from prunus.measure import branches
from prunus.model import Ints, Skeleton


def drop_stubs(skeleton: Skeleton, tips: Ints, min_length: float) -> Skeleton:
    """The skeleton without leaders that are shorter than `min_length` and end at no tip."""
    kept = np.ones(len(skeleton), np.bool_)
    for branch in branches(skeleton, TIP_LABEL):
        if branch.length < min_length and skeleton.superpoint[branch.rows[-1]] not in tips:
            kept[branch.rows[1:]] = False
    new_row = np.cumsum(kept) - 1
    parent = np.where(skeleton.parent >= 0, new_row[skeleton.parent], -1)
    return Skeleton(
        skeleton.xyz[kept],
        parent[kept],
        skeleton.label[kept],
        skeleton.confidence[kept],
        skeleton.radius[kept],
        skeleton.superpoint[kept],
    )
