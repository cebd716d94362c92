"""Which labels may be added where: the rules of `rules.py` as an automaton over node states.

A state is what the rules see of a node: the incoming label and how many edges of each label go
out, counted up to one more than any rule cares for. The states are found by asking the rules.
"""

from __future__ import annotations

from functools import cache
from itertools import product

import numpy as np

from prunus.grammar import MAX_SUPPORTS, SEARCHED, TIP_LABEL
from prunus.model import Ints, Label
from prunus.paper.kernels.tables import GrammarTable
from prunus.rules import ROOT, RULES

MANY = MAX_SUPPORTS + 1
"""Counts of outgoing edges stop here: no rule tells more apart."""


@cache
def grammar_table(labels: tuple[Label, ...] = SEARCHED) -> GrammarTable:
    """The automaton over these labels. State 0 is the base before anything grew."""
    states = _legal_states(labels)
    number = {state: index for index, state in enumerate(states)}
    following = np.full((len(states), len(labels)), -1, np.int64)
    for (incoming, counts), index in number.items():
        for label in labels:
            more = list(counts)
            more[label] = min(more[label] + 1, MANY)
            following[index, label] = number.get((incoming, tuple(more)), -1)
    kind, following = _merged(np.array([incoming for incoming, _ in states]), following)
    nothing = (0,) * len(labels)
    return GrammarTable(
        following,
        np.array([kind[number[label, nothing]] for label in labels]),
        np.asarray((following >= 0).any(axis=1)),
        np.array([TIP_LABEL - label for label in labels]),
    )


def _legal_states(labels: tuple[Label, ...]) -> list[tuple[int, tuple[int, ...]]]:
    counts = list(product(range(MANY + 1), repeat=len(labels)))
    states = [(incoming, count) for incoming in (ROOT, *labels) for count in counts]
    incoming = np.array([state[0] for state in states])
    outgoing = np.zeros((len(states), len(Label)), np.int64)
    outgoing[:, : len(labels)] = [state[1] for state in states]
    broken = np.any([rule(incoming, outgoing) for rule in RULES], axis=0)
    return [state for state, illegal in zip(states, broken, strict=True) if not illegal]


def _merged(incoming: Ints, following: Ints) -> tuple[Ints, Ints]:
    """States of one incoming label with the same future as one: the new state of each, the table.

    Of an automaton in which all states of a label stand together, so they do after it.
    """
    kind, kinds = incoming - incoming.min(), 0
    while kind.max() >= kinds:
        kinds = int(kind.max()) + 1
        ahead = np.where(following >= 0, kind[following], -1)
        _, first, new = np.unique(
            np.column_stack([kind, ahead]), axis=0, return_index=True, return_inverse=True
        )
        rank = np.argsort(np.argsort(first))
        kind = rank[new.ravel()]
    _, first = np.unique(kind, return_index=True)
    table = following[first]
    return kind, np.where(table >= 0, kind[table], -1)
