"""Which labels may be added where: the rules of `rules.py` as an automaton over node states.

A state is what the rules see of a node: the incoming label and how many edges of each label go
out, counted up to one more than any rule cares for. The states are found by asking the rules.
"""

from __future__ import annotations

from functools import cache
from itertools import product

import numpy as np

from prunus.grammar import MAX_SUPPORTS, SEARCHED, TIP_LABEL
from prunus.kernels.tables import GrammarTable
from prunus.model import Label
from prunus.rules import ROOT, RULES

MANY = MAX_SUPPORTS + 1
"""Counts of outgoing edges stop here: no rule tells more apart."""


@cache
def grammar_table() -> GrammarTable:
    """The automaton. State 0 is the base before anything grew."""
    states = _legal_states()
    number = {state: index for index, state in enumerate(states)}
    following = np.full((len(states), len(SEARCHED)), -1, np.int64)
    for (incoming, counts), index in number.items():
        for label in SEARCHED:
            more = list(counts)
            more[label] = min(more[label] + 1, MANY)
            following[index, label] = number.get((incoming, tuple(more)), -1)
    nothing = (0,) * len(SEARCHED)
    return GrammarTable(
        following,
        np.array([number[label, nothing] for label in SEARCHED]),
        np.asarray((following >= 0).any(axis=1)),
        np.array([TIP_LABEL - label for label in SEARCHED]),
    )


def _legal_states() -> list[tuple[int, tuple[int, ...]]]:
    counts = list(product(range(MANY + 1), repeat=len(SEARCHED)))
    states = [(incoming, count) for incoming in (ROOT, *SEARCHED) for count in counts]
    incoming = np.array([state[0] for state in states])
    outgoing = np.zeros((len(states), len(Label)), np.int64)
    outgoing[:, : len(SEARCHED)] = [state[1] for state in states]
    broken = np.any([rule(incoming, outgoing) for rule in RULES], axis=0)
    return [state for state, illegal in zip(states, broken, strict=True) if not illegal]
