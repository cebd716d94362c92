"""The search again, holding what a person corrected.

Edges that were removed are not in its graph; those that were added or relabelled are sure, of the
label they were given. A search may still leave one out, and then it is put back.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from prunus.editing.draft import Draft, Pair, pair_of
from prunus.editing.refused import Refused
from prunus.editing.relabel import relabelled
from prunus.editing.settle import Allowed, settled
from prunus.geometry.near import within
from prunus.model import (
    CandidateGraph,
    Floats,
    Ints,
    Label,
    ScoredGraph,
    SeededGraph,
    Skeleton,
    Superpoints,
)
from prunus.params import Parameters


@dataclass(frozen=True)
class Held:
    """What was corrected: the labels of edges that stay, and edges that stay away."""

    label: Mapping[Pair, Label] = field(default_factory=dict)
    removed: frozenset[Pair] = frozenset()

    def after(self, before: Draft, now: Draft, told: frozenset[int]) -> Held:
        """The same after another act, in which the label of the edges into some nodes was told."""
        old, new = _edges(before), _edges(now)
        gone = (self.removed | (old.keys() - new.keys())) - new.keys()
        confirmed = {pair_of(now.into[node][0], node) for node in told}
        other = {pair for pair, label in new.items() if old.get(pair) != label}
        kept = {pair for pair in self.label if pair in new} | confirmed | other
        return Held({pair: new[pair] for pair in sorted(kept)}, frozenset(gone))


NOTHING = Held()
"""Nothing was corrected."""


def _edges(draft: Draft) -> dict[Pair, Label]:
    return {pair_of(above, node): label for node, (above, label) in draft.into.items()}


def searched(draft: Draft, held: Held, graph: SeededGraph, params: Parameters, seed: int) -> Draft:
    """The best skeleton that holds what was corrected; under the default method the best labels.

    Raises Refused, naming the edges, where none could be made that does.
    """
    nodes = [n for n in draft.nodes[1:] if pair_of(draft.into[n][0], n) in held.label]
    if params.method == "default":
        best = relabelled(draft, held.label, graph) if held != NOTHING else draft
        if lost := _lost(best, draft, nodes):
            raise _refusal(draft, lost)
        return best
    if held == NOTHING and draft.base == graph.base:
        return draft
    seeded = held_graph(draft, held, graph)
    # Here, since it takes a compiler.
    from prunus.paper.chain import Search

    found = Search().best(seeded, params, np.random.default_rng(seed), {}).skeleton
    best = _draft_of(found, draft)
    for back in (_lost(best, draft, nodes), nodes):
        whole = _put_back(best, draft, back)
        right = settled(whole, Allowed(kept=nodes, relabel=True, remove=True))
        if right is not None and not _lost(right, draft, nodes):
            return right
    raise _refusal(draft, _lost(best, draft, nodes))


def _refusal(draft: Draft, lost: list[int]) -> Refused:
    edges = ", ".join(f"{draft.into[node][0]} to {node}" for node in lost)
    text = f"no tree holds the corrected edges {edges}"
    return Refused(text, "keeps_corrections", lost).at(draft)


def _draft_of(skeleton: Skeleton, draft: Draft) -> Draft:
    nodes = skeleton.superpoint.tolist()
    rows = zip(nodes[1:], skeleton.parent[1:].tolist(), skeleton.label[1:].tolist(), strict=True)
    return replace(draft, into={node: (nodes[above], Label(label)) for node, above, label in rows})


def _lost(found: Draft, draft: Draft, nodes: list[int]) -> list[int]:
    """The nodes whose edge, or its label, another draft has not."""
    return [node for node in nodes if found.into.get(node) != draft.into[node]]


def _put_back(found: Draft, draft: Draft, nodes: list[int]) -> Draft:
    """A draft with the ways of another to some nodes.

    What hangs on a node of these ways goes on hanging there, so that it is a tree again.
    """
    ways = {one for node in nodes for one in draft.below(node)} - {draft.base}
    return found.changed({node: draft.into[node] for node in ways})


def held_graph(draft: Draft, held: Held, graph: SeededGraph) -> SeededGraph:
    """The graph on which to search again, over all nodes of the draft, from its base."""
    pairs = [pair for pair in graph.edges.tolist() if tuple(pair) not in held.removed]
    known = {tuple(pair) for pair in pairs}
    more = [pair for pair in held.label if pair not in known]
    edges = np.array([*pairs, *more], np.int64).reshape(-1, 2)
    edges = edges[np.lexsort([edges[:, 1], edges[:, 0]])]
    confidence, category = _told_of(edges, graph)
    for row, (i, j) in enumerate(edges.tolist()):
        label = held.label.get((i, j))
        if label is not None:
            confidence[row] = 1.0
            category[row] = np.arange(category.shape[1]) == label
    candidates = CandidateGraph(_all_nodes(draft, graph.superpoints), edges)
    scored = ScoredGraph(
        candidates=candidates, confidence=confidence, category=category, scorer=graph.scored.scorer
    )
    return SeededGraph(scored, draft.base, graph.tips[graph.tips != draft.base])


def _told_of(edges: Ints, graph: SeededGraph) -> tuple[Floats, Floats]:
    """The confidence and category of edges; nothing for those that were no candidates."""
    row_of = {tuple(pair): row for row, pair in enumerate(graph.edges.tolist())}
    rows = np.array([row_of.get(tuple(pair), -1) for pair in edges.tolist()], np.int64)
    confidence = np.where(rows >= 0, np.append(graph.confidence, 0.0)[rows], 0.0)
    kinds = graph.scored.category.shape[1]
    category = np.concatenate([graph.scored.category, np.zeros((1, kinds))])[rows]
    return confidence, category


def _all_nodes(draft: Draft, own: Superpoints) -> Superpoints:
    """The superpoints with the free points after them."""
    free = draft.places[draft.superpoints :]
    start, members = within(own.cloud.xyz, free, own.radius)
    return Superpoints(
        own.cloud,
        np.concatenate([own.xyz, free]),
        np.concatenate([own.start, own.start[-1] + start[1:]]),
        np.concatenate([own.members, members]),
        own.radius,
    )
