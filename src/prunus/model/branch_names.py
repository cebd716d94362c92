"""Branches by the names under which a person sees them: leader 3 is the third from the left."""

from __future__ import annotations

from prunus.model import Label, Skeleton
from prunus.model.branches import Branch

NOUNS = {label: label.word.replace("_", " ") for label in Label}
"""Labels as words."""


def branch_names(skeleton: Skeleton, found: list[Branch]) -> list[str]:
    """The name of each branch of a skeleton in the house frame.

    Branches of one label are numbered along the row, as `leaders` numbers leaders; a trunk
    that is the only one is `the trunk`.
    """
    names = [""] * len(found)
    for label in Label:
        some = [number for number, branch in enumerate(found) if branch.label == label]
        some.sort(key=lambda n: (float(skeleton.xyz[found[n].rows, 0].mean()), found[n].rows[-1]))
        alone = label == Label.TRUNK and len(some) == 1
        for count, number in enumerate(some, 1):
            names[number] = "the trunk" if alone else f"{NOUNS[label]} {count}"
    return names
