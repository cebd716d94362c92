"""The structural rules of a labelled tree, each a named predicate that returns the offenders.

A rule sees junctions: for each node the label of the edge that comes in (`ROOT` at the base) and
how many edges of each label go out. The search, the tests and the evaluation use the same list
(sec. Label-based topological constraints).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from prunus.grammar import MAX_SUPPORTS, SIDE_BRANCH_PARENTS
from prunus.model import Bools, Ints, Label, Skeleton

ROOT = -1
"""In place of a label: nothing comes in, this is the base."""

Rule = Callable[[Ints, Ints], Bools]


def label_progression(incoming: Ints, outgoing: Ints) -> Bools:
    """The order of labels never falls: Order(L(e_p)) <= Order(L(e_s))."""
    lower = np.arange(len(Label)) < incoming[:, None]
    return np.asarray((outgoing * lower).any(axis=1))


def label_linearity(incoming: Ints, outgoing: Ints) -> Bools:
    """No Y of one label: at most one successor carries the label of its predecessor."""
    same = np.take_along_axis(outgoing, np.maximum(incoming, 0)[:, None], axis=1)[:, 0]
    return np.asarray((incoming != ROOT) & (same > 1))


def trunk_support_split(incoming: Ints, outgoing: Ints) -> Bools:
    """Where anything else leaves the trunk, the trunk ends, in at most two supports."""
    trunk = outgoing[:, Label.TRUNK]
    others = outgoing.sum(axis=1) - trunk
    halfway = (trunk > 0) & (others > 0)
    crowded = outgoing[:, Label.SUPPORT] > MAX_SUPPORTS
    return np.asarray((incoming == Label.TRUNK) & (halfway | crowded))


def one_trunk_at_base(incoming: Ints, outgoing: Ints) -> Bools:
    """From the base only a trunk starts, and once."""
    trunk = outgoing[:, Label.TRUNK]
    others = outgoing.sum(axis=1) - trunk
    return np.asarray((incoming == ROOT) & ((trunk > 1) | (others > 0)))


def side_branches_on_leaders(incoming: Ints, outgoing: Ints) -> Bools:
    """Side branches leave leaders (or go on from side branches)."""
    allowed = np.isin(incoming, [*SIDE_BRANCH_PARENTS, Label.SIDE_BRANCH])
    return np.asarray(~allowed & (outgoing[:, Label.SIDE_BRANCH] > 0))


RULES: tuple[Rule, ...] = (
    label_progression,
    label_linearity,
    trunk_support_split,
    one_trunk_at_base,
    side_branches_on_leaders,
)


def junctions(skeleton: Skeleton) -> tuple[Ints, Ints]:
    """For each node the incoming label (M,) and the count of outgoing labels (M, 4)."""
    incoming = skeleton.label.astype(np.int64)
    incoming[0] = ROOT
    outgoing = np.zeros((len(skeleton), len(Label)), np.int64)
    np.add.at(outgoing, (skeleton.parent[1:], skeleton.label[1:]), 1)
    return incoming, outgoing


def offenders(skeleton: Skeleton) -> dict[str, Ints]:
    """The rows at which a rule is broken, by the name of the rule; empty for a legal skeleton."""
    table = junctions(skeleton)
    broken = {rule.__name__: np.flatnonzero(rule(*table)) for rule in RULES}
    return {name: rows for name, rows in broken.items() if len(rows)}


def can_leave(parent: Label | None, label: Label) -> bool:
    """Whether the rules let a branch of that label leave one of another; None is the base."""
    incoming = np.array([ROOT if parent is None else int(parent)])
    outgoing = np.zeros((1, len(Label)), np.int64)
    outgoing[0, label] = 1
    return not any(rule(incoming, outgoing)[0] for rule in RULES)
