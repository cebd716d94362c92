"""Branches by the names under which a person sees them: leader 3 is the third from the left."""

from __future__ import annotations

from prunus.editing.draft import Draft
from prunus.model import Label
from prunus.model.branch_names import NOUNS
from prunus.model.branch_names import branch_names as names_of_branches
from prunus.model.branches import branches

RULES = {
    "label_progression": "along a branch the order trunk, support, leader, side branch never falls",
    "label_linearity": "a branch goes on as one, it does not fork into two of its label",
    "trunk_support_split": "where anything else leaves the trunk it ends, in two supports at most",
    "one_trunk_at_base": "from the base only the trunk starts, and once",
    "side_branches_on_leaders": "side branches leave leaders",
}
"""What each rule of `rules.py` asks, in words."""
OTHERS = {
    "stays_a_tree": "a path starts in the tree and ends outside it; there are no loops",
    "keeps_its_trunk": "the first edge of the trunk stays",
    "no_way": "a routed path follows candidate edges outside the tree",
    "near_the_scan": "what is added lies near the scan",
    "changes_something": "an act changes something",
    "holds_the_tree": "the points left hold a tree",
    "keeps_corrections": "a new search keeps what was corrected",
}
"""What else is asked of an act, in words."""


def branch_names(draft: Draft) -> dict[int, str]:
    """The name of the branch that holds the edge into each node, and of the base.

    Branches of one label are numbered along the row as `leaders` numbers leaders.
    """
    skeleton = draft.numbered()
    found = branches(skeleton)
    names = {draft.base: "the base"}
    for branch, name in zip(found, names_of_branches(skeleton, found), strict=True):
        names |= {draft.nodes[row]: name for row in branch.rows[1:].tolist()}
    return names


def a_branch(label: Label) -> str:
    """`a leader`, `a side branch`."""
    return "the trunk" if label == Label.TRUNK else f"a {NOUNS[label]}"


def listed(names: list[str]) -> str:
    """`leader 1, leader 2 and leader 4`; of many the first few."""
    unique = list(dict.fromkeys(names))
    if len(unique) > MOST:
        return f"{', '.join(unique[:MOST])} and {len(unique) - MOST} more"
    return " and ".join([", ".join(unique[:-1]), unique[-1]] if len(unique) > 1 else unique)


MOST = 3
"""So many branches are named."""
