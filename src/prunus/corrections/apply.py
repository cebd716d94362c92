"""An act on a skeleton, with the rules asked: after it the tree is legal, or it is refused."""

from __future__ import annotations

from prunus.corrections.acts import Step, Together
from prunus.corrections.draft import Draft
from prunus.corrections.refused import Refused
from prunus.corrections.repairs import repairs
from prunus.corrections.steps import Stepped, stepped
from prunus.corrections.words import RULES, branch_names, listed
from prunus.model import Ints, SeededGraph
from prunus.rules import offenders

__all__ = ["Refused", "corrected"]


def corrected(draft: Draft, act: Step | Together, graph: SeededGraph) -> Stepped:
    """The draft after an act, a legal tree.

    Raises Refused, with what could be done instead, where it would not be one, and PrunusError
    where the act names what is not there.
    """
    try:
        done = stepped(draft, act, graph)
    except Refused as refused:
        refused.repairs = repairs(draft, act, None, graph)
        raise
    broken = offenders(done.draft.skeleton())
    if broken:
        raise _refusal(draft, act, done, broken, graph)
    return done


def _refusal(
    draft: Draft, act: Step | Together, wrong: Stepped, broken: dict[str, Ints], graph: SeededGraph
) -> Refused:
    rule = next(iter(broken))
    nodes = [wrong.draft.nodes[row] for row in broken[rule].tolist()]
    names = branch_names(draft)
    where = listed([names.get(node, "the new path") for node in nodes])
    text = f"{rule}: {RULES[rule]}; it would be broken at {where}"
    return Refused(text, rule, nodes, repairs(draft, act, wrong, graph)).at(wrong.draft)
