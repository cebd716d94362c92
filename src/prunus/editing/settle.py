"""The legal tree nearest to one that breaks a rule: exact, from the leaves down to the base.

What the rules see of a node is a state of the automaton of `paper.eligible`. Of each node and
each label that its edge may have, the least is worked out that must change beyond it.
"""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass

from prunus.editing.draft import Draft
from prunus.model import Label
from prunus.paper.eligible import grammar_table

REMOVED = 3.0
"""A metre that is taken away costs as much as so many that change their label once."""
EACH = 0.01
"""Each edge counts as so many metres more."""

Chosen = tuple["Chosen | None", int, Label]
"""Children and their labels as a chain: those before, a node, its label."""
Found = dict[Label | None, tuple[float, Chosen | None]]
"""By the label that comes in (None at the base): the least cost beyond, and what is kept."""


@dataclass(frozen=True, kw_only=True)
class Allowed:
    """What may change: labels, and whether wood may be taken away.

    Edges into `kept` keep their label, and those into `kept` and `stays` are not taken away.
    """

    kept: Collection[int]
    relabel: bool
    remove: bool
    stays: Collection[int] = ()


def settled(draft: Draft, allowed: Allowed) -> Draft | None:
    """The nearest legal tree; None where what may change does not make it legal."""
    kept = {*allowed.kept, *allowed.stays}
    removed, holds = dict[int, float](), dict[int, bool]()
    best: dict[int, Found] = {}
    for node in reversed(draft.nodes):
        after = draft.after[node]
        if node != draft.base:
            own = REMOVED * (draft.length(node) + EACH)
            removed[node] = own + sum(removed[child] for child in after)
            holds[node] = node in kept or any(holds[child] for child in after)
        gone = {n: removed[n] for n in after if allowed.remove and not holds[n]}
        labels: list[Label | None] = [None] if node == draft.base else list(Label)
        best[node] = {}
        for label in labels:
            found = _least(draft, node, label, best, gone, allowed)
            if found is not None:
                best[node][label] = found
    if None not in best[draft.base]:
        return None
    return _followed(draft, best)


def _least(
    draft: Draft,
    node: int,
    label: Label | None,
    best: dict[int, Found],
    gone: dict[int, float],
    allowed: Allowed,
) -> tuple[float, Chosen | None] | None:
    """The least cost of what hangs on a node with this label coming in."""
    grammar = grammar_table(tuple(Label))
    start = 0 if label is None else int(grammar.fresh[label])
    reached: dict[int, tuple[float, Chosen | None]] = {start: (0.0, None)}
    for child in draft.after[node]:
        further: dict[int, tuple[float, Chosen | None]] = {}
        for state, (cost, chosen) in reached.items():
            options = [(state, gone[child], chosen)] if child in gone else []
            for under, (beyond, _) in best[child].items():
                assert under is not None
                to = int(grammar.following[state, under])
                price = _price(draft, child, under, allowed)
                if to >= 0 and math.isfinite(price):
                    options.append((to, price + beyond, (chosen, child, under)))
            for to, more, then in options:
                if to not in further or cost + more < further[to][0]:
                    further[to] = (cost + more, then)
        reached = further
    return min(reached.values(), key=lambda one: one[0], default=None)


def _price(draft: Draft, node: int, label: Label, allowed: Allowed) -> float:
    """What it costs that the edge into a node has this label."""
    steps = abs(label - draft.into[node][1])
    if steps == 0:
        return 0.0
    if not allowed.relabel or node in allowed.kept:
        return math.inf
    return (draft.length(node) + EACH) * (1 + 0.1 * (steps - 1))


def _followed(draft: Draft, best: dict[int, Found]) -> Draft:
    """The tree of the choices."""
    into: dict[int, tuple[int, Label]] = {}
    waiting: list[tuple[int, Label | None]] = [(draft.base, None)]
    while waiting:
        node, label = waiting.pop()
        chosen = best[node][label][1]
        while chosen is not None:
            chosen, child, under = chosen
            into[child] = (node, under)
            waiting.append((child, under))
    gone = dict.fromkeys(node for node in draft.into if node not in into)
    return draft.changed({**into, **gone})
