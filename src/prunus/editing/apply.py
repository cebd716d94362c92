"""An act on a skeleton, with the rules asked: it breaks none, or it is refused."""

from __future__ import annotations

from prunus.editing.acts import Step, Together
from prunus.editing.draft import Draft
from prunus.editing.legal import newly_broken
from prunus.editing.refused import Refused
from prunus.editing.repairs import repairs
from prunus.editing.steps import Stepped, stepped
from prunus.editing.words import RULES, branch_names, listed
from prunus.model import SeededGraph

__all__ = ["Refused", "corrected"]


def corrected(draft: Draft, act: Step | Together, graph: SeededGraph) -> Stepped:
    """The draft after an act: a tree in which no rule is broken that held before.

    Raises Refused, with what could be done instead, where it would not be one, and PrunusError
    where the act names what is not there.
    """
    try:
        done = stepped(draft, act, graph)
    except Refused as refused:
        refused.repairs = repairs(draft, act, None, graph)
        raise
    broken = newly_broken(draft, done.draft)
    if broken:
        raise _refusal(draft, act, done, broken, graph)
    return done


def _refusal(
    draft: Draft,
    act: Step | Together,
    wrong: Stepped,
    broken: dict[str, list[int]],
    graph: SeededGraph,
) -> Refused:
    rule = next(iter(broken))
    nodes = broken[rule]
    names = branch_names(draft)
    where = listed([names.get(node, "the new path") for node in nodes])
    text = f"{rule}: {RULES[rule]}; it would be broken at {where}"
    return Refused(text, rule, nodes, repairs(draft, act, wrong, graph)).at(wrong.draft)
