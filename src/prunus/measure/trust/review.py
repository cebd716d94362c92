"""Why a person should look at a tree before a machine acts on it."""

from __future__ import annotations

from prunus.measure.branches import branches
from prunus.measure.names import branch_names
from prunus.measure.trust import Trust
from prunus.model import Label, Skeleton

TREE = 0.85
"""Where a smaller share of the edges is likely right, a person looks."""
FRAME = 0.30
"""Trunk, supports and leaders less likely right than this are looked at."""


def review_of(skeleton: Skeleton, trust: Trust) -> list[str]:
    """What is doubtful about a skeleton in the house frame as a whole; often nothing."""
    found = []
    if trust.tree < TREE:
        found.append(f"only {trust.tree:.0%} of its edges are likely right")
    some = branches(skeleton)
    for name, branch, likely in zip(
        branch_names(skeleton, some), some, trust.branch.tolist(), strict=True
    ):
        if branch.label != Label.SIDE_BRANCH and likely < FRAME:
            found.append(f"{name} is likely wrong ({likely:.0%} sure)")
    return found
