"""Why a person should look at a tree before a machine acts on it."""

from __future__ import annotations

from prunus.model import Label, Skeleton
from prunus.model.branch_names import branch_names
from prunus.model.branches import branches
from prunus.trust import WOOD, Trust

TREE = 0.85
"""Where a smaller share of the edges is likely right, a person looks."""
FRAME = 0.30
"""Trunk, supports and leaders less likely right than this are looked at."""


FORM, MEANT = 0.82, 0.70
"""So likely is it of the form that was learned, and the one that is meant, where nothing is said of
it. Of 26 trees of other forms four tiered ones had a form of 0.82 and more; of 60 UFO trees 4 had
less, most of them wild or badly scanned (`bench.trust_cases`)."""


def whole_review(trust: Trust) -> list[str]:
    """What is doubtful about a tree before its branches are looked at; often nothing."""
    found = []
    if trust.wood < WOOD:
        found.append(
            f"not my kind of tree: {trust.wood:.0%} likely a bare fruit tree at all, by how its "
            "wood runs; nothing in it is to be trusted before a person has looked"
        )
    if trust.form < FORM:
        found.append(
            f"not my kind of tree: {trust.form:.0%} likely trained as a UFO tree; where its "
            "branches run may be right, what they are called means little"
        )
    if trust.meant < MEANT:
        found.append(
            f"another tree in view may be meant as well ({trust.meant:.0%} likely this one): "
            "--base says which"
        )
    return found


def review_of(skeleton: Skeleton, trust: Trust) -> list[str]:
    """What is doubtful about a skeleton in the house frame as a whole; often nothing."""
    found = whole_review(trust)
    if trust.tree < TREE:
        found.append(f"only {trust.tree:.0%} of its edges are likely right")
    some = branches(skeleton)
    # That another tree may be meant, or this be none, is said above once, not of every branch.
    least = FRAME * trust.whole
    for name, branch, likely in zip(
        branch_names(skeleton, some), some, trust.branch.tolist(), strict=True
    ):
        if branch.label != Label.SIDE_BRANCH and likely < least:
            found.append(f"{name} is likely wrong ({likely:.0%} sure)")
    return found
