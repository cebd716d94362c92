"""A skeleton under correction: a tree over the superpoints of its graph and points that were added.

Nodes are numbered for good: superpoints 0 to N - 1, free points N, N + 1, ... as they were added.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from prunus.errors import PrunusError
from prunus.model import Floats, Label, SeededGraph, Skeleton, parents_first
from prunus.result import Result

Pair = tuple[int, int]
Into = Mapping[int, tuple[int, Label]]
"""Of each node but the base: the node before it, and the label of the edge between."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Draft:
    """A tree as what comes into each node.

    places (N + F, 3), house frame, of superpoints and free points, in the tree or not;
    `superpoints` N; `confidence` of each candidate edge, the smaller node first.
    """

    places: Floats
    superpoints: int
    base: int
    into: Into
    confidence: Mapping[Pair, float]

    @classmethod
    def of(cls, result: Result) -> Draft:
        """The skeleton that the machine found. Its ends may stand farther out than their nodes."""
        graph, skeleton = result.graph, result.in_house
        nodes = skeleton.superpoint.tolist()
        places = graph.xyz.copy()
        places[nodes] = skeleton.xyz
        rows = zip(nodes[1:], skeleton.parent[1:].tolist(), skeleton.label[1:], strict=True)
        into = {node: (nodes[above], Label(label)) for node, above, label in rows}
        return cls(
            places=places,
            superpoints=len(graph.xyz),
            base=nodes[0],
            into=into,
            confidence=confidences(graph),
        )

    def __contains__(self, node: int) -> bool:
        return node == self.base or node in self.into

    @cached_property
    def nodes(self) -> list[int]:
        """The node in each row (M,) of the skeleton, the base first."""
        return self._rows[0]

    @cached_property
    def after(self) -> dict[int, list[int]]:
        """The nodes that hang on each node, in the order of their rows."""
        found: dict[int, list[int]] = {node: [] for node in self.nodes}
        for node in self.nodes[1:]:
            found[self.into[node][0]].append(node)
        return found

    @cached_property
    def _rows(self) -> tuple[list[int], list[int]]:
        return parents_first(self.base, {node: self.into[node][0] for node in sorted(self.into)})

    def skeleton(self) -> Skeleton:
        """The tree in the house frame. Free points have no superpoint."""
        numbered = self.numbered()
        known = numbered.superpoint < self.superpoints
        return replace(numbered, superpoint=np.where(known, numbered.superpoint, -1))

    def numbered(self) -> Skeleton:
        """The tree in the house frame, with the node of each row in place of its superpoint."""
        nodes, parent = self._rows
        label = [int(self.into[node][1]) for node in nodes[1:]]
        pairs = [pair_of(self.into[node][0], node) for node in nodes[1:]]
        return Skeleton.build(
            self.places[nodes],
            parent,
            [*(label[:1] or [int(Label.TRUNK)]), *label],
            confidence=[np.nan, *(self.confidence.get(pair, np.nan) for pair in pairs)],
            superpoint=nodes,
        )

    def length(self, node: int) -> float:
        """Metres of the edge into a node."""
        return float(np.linalg.norm(self.places[node] - self.places[self.into[node][0]]))

    def beyond(self, node: int) -> list[int]:
        """A node and all that hangs on it, parents first."""
        found = [node]
        for one in found:
            found += self.after[one]
        return found

    def below(self, node: int) -> list[int]:
        """A node and those before it, down to the base."""
        found = [node]
        while found[-1] != self.base:
            found.append(self.into[found[-1]][0])
        return found

    def onward(self, node: int) -> list[int]:
        """The nodes of a branch from one of them to its tip."""
        found = [node]
        while (further := self._continues(found[-1])) is not None:
            found.append(further)
        return found

    def until(self, node: int) -> list[int]:
        """The nodes of a branch from its first to one of them."""
        branch = self.branch(node)
        return branch[: branch.index(node) + 1]

    def branch(self, node: int) -> list[int]:
        """The nodes of the branch (see `branches`) that holds the edge into a node."""
        first = node
        while (before := self.into[first][0]) != self.base and self._continues(before) == first:
            first = before
        return self.onward(first)

    def _continues(self, node: int) -> int | None:
        """The node after one on the same branch."""
        own = self.into[node][1]
        return next((after for after in self.after[node] if self.into[after][1] == own), None)

    def changed(
        self, into: Mapping[int, tuple[int, Label] | None], base: int | None = None
    ) -> Draft:
        """The same with other edges into some nodes, None for none."""
        every = {**self.into, **into}
        left = {node: edge for node, edge in every.items() if edge is not None}
        return replace(self, into=left, base=self.base if base is None else base)

    def with_places(self, more: Iterable[Floats]) -> Draft:
        """The same with further free points (3,), house frame."""
        added = [np.asarray(place, np.float64)[None] for place in more]
        return replace(self, places=np.concatenate([self.places, *added])) if added else self

    def require(self, node: int, edge: bool = True) -> None:
        """Raise PrunusError where a node is not in the tree, or is the base where an edge is."""
        if node >= len(self.places):
            raise PrunusError(f"node {node}: there are only nodes 0 to {len(self.places) - 1}")
        if node not in self:
            raise PrunusError(f"node {node} is not in the tree; expected one that is")
        if edge and node == self.base:
            raise PrunusError(f"node {node} is the base; expected a node with an edge into it")


def pair_of(one: int, other: int) -> Pair:
    """Two nodes, the smaller first."""
    return (one, other) if one < other else (other, one)


def confidences(graph: SeededGraph) -> dict[Pair, float]:
    """The confidence of each candidate edge."""
    pairs = (pair_of(i, j) for i, j in graph.edges.tolist())
    return dict(zip(pairs, graph.confidence.tolist(), strict=True))
