"""The tables that the population search works on.

A skeleton is a row of N entries: for each node the code of the edge that enters it (edge * LABELS
+ label), or ABSENT, or BASE. Beside it stand the grammar state of each node, the node set as 64-bit
words, the tips not yet given up, the score, and a key: the exclusive or of random numbers, one for
each (edge, label) (Zobrist hashing). Equal skeletons are one row with a number of copies.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from prunus.model.arrays import Bools, Floats, Ints
from prunus.paper.kernels.paths import Words

ABSENT = -1
"""The entry of a node outside the skeleton."""
BASE = -2
"""The entry of the base: no edge enters it."""
LABELS = 4
"""An entry is edge * LABELS + label."""


class GraphTable(NamedTuple):
    """The directed edges d, sorted by tail, and what each brings.

    tail, head (D,); out_start (N + 1,); gain (D, L) EdgeScore less GrowPenalty under each label;
    turn (C, pairs): the cost of d followed by d' at pair_of[d] + d', for each kind of change;
    change (L, L): the kind that it is to go on from one label with another, -1 = free; key (D, L)
    random 64-bit numbers.
    """

    tail: Ints
    head: Ints
    out_start: Ints
    gain: Floats
    turn: Floats
    pair_of: Ints
    change: Ints
    key: Words


class PriorTable(NamedTuple):
    """Path priors by tip: on_path (T, D, W); after, first, second (T, D). See `tip_paths`."""

    on_path: Words
    after: Floats
    first: Floats
    second: Floats


class GrammarTable(NamedTuple):
    """The rules as an automaton over node states.

    following (S, L) the state after one more outgoing edge of that label, -1 = illegal; fresh (L,)
    the state of a node just reached; is_open (S,) whether anything may still leave; free_turns
    (L,) how many turns a path may still make for changes of label: 2 - Order(l).
    """

    following: Ints
    fresh: Ints
    is_open: Bools
    free_turns: Ints


class Population(NamedTuple):
    """U different skeletons: entry, state (U, N), nodes (U, W), live tips (U, WT), others (U,).

    `frontier[start[u] : start[u + 1]]` are the edges that leave an open node of u for a free one.
    """

    entry: NDArray[np.int32]
    state: NDArray[np.int16]
    nodes: Words
    live: Words
    frontier: NDArray[np.int32]
    start: Ints
    key: Words
    score: Floats
    copies: Ints


class Proposals(NamedTuple):
    """Additions (Q,): the skeleton that grows, the edge, the label, the weight."""

    parent: Ints
    edge: Ints
    label: Ints
    weight: Floats
