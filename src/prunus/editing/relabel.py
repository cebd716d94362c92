"""The labels of a tree chosen anew, around those that a person told."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from prunus.editing.draft import Draft, Pair, pair_of
from prunus.growth.labels import label_tree
from prunus.growth.shape import Tree
from prunus.model import Floats, Label, Role, SeededGraph

CERTAIN_M = 1e3
"""An edge whose label a person told has as much say as so many metres of wood."""


def relabelled(draft: Draft, told: Mapping[Pair, Label], graph: SeededGraph) -> Draft:
    """The draft under the best labels, by the categories of the edges of a graph.

    Edges that the graph does not have may have any label; those that were told keep theirs, unless
    the grammar forbids all of them together.
    """
    pairs = [pair_of(draft.into[node][0], node) for node in draft.nodes[1:]]
    parent = draft.skeleton().parent
    tree = Tree(draft.places[draft.nodes], parent)
    _ = tree.turn  # by true lengths, before certain edges become long
    tree.step[1:][[pair in told for pair in pairs]] = CERTAIN_M
    label = label_tree(tree, _roles(pairs, told, graph)).label.tolist()
    own = zip(draft.nodes[1:], label[1:], strict=True)
    return replace(draft, into={node: (draft.into[node][0], Label(one)) for node, one in own})


def _roles(pairs: list[Pair], told: Mapping[Pair, Label], graph: SeededGraph) -> Floats:
    """The roles (M, 6) at the rows of a tree, of the edges (M - 1) into all but the first."""
    known = dict(zip(map(tuple, graph.edges.tolist()), graph.scored.category, strict=True))
    anything = np.full(graph.scored.category.shape[1], 1 / max(graph.scored.category.shape[1], 1))
    roles = np.zeros((len(pairs) + 1, len(Role)))
    for row, pair in enumerate(pairs, 1):
        if pair in told:
            roles[row, told[pair]] = 1.0
        else:
            roles[row, : len(anything)] = known.get(pair, anything)
    roles[0] = roles[min(1, len(pairs))]
    return roles
