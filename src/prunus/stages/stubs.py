"""Drop stubs: leaders too short to be one.

The search grows every edge towards some tip, but a branch may stop when its tip is reached from
elsewhere, and a bend may look like a tip. What is left is no leader.
"""

from __future__ import annotations

import numpy as np

from prunus.grammar import TIP_LABEL
from prunus.measure import branches
from prunus.model import Skeleton


def drop_stubs(skeleton: Skeleton, min_length: float) -> Skeleton:
    """The skeleton without leaders shorter than `min_length`, metres."""
    kept = np.ones(len(skeleton), np.bool_)
    for branch in branches(skeleton, TIP_LABEL):
        if branch.length < min_length:
            kept[branch.rows[1:]] = False
    return skeleton.part(kept)
