"""The candidate edges of a tree in the order in which they are asked for, and what was said."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from prunus.io.labels import Category, EdgeLabel, LabelHead, append_label, read_labels
from prunus.model import Ints, RigidMotion, ScoredGraph

Verdict = tuple[bool, Category | None]


@dataclass(kw_only=True)
class Queue:
    """One after another, those nearest to a confidence of one half first.

    `order` (E,) are the edges; `at` the place in it; `given` what was said of an edge.
    """

    graph: ScoredGraph
    to_input: RigidMotion
    path: Path
    head: LabelHead
    order: Ints
    given: dict[int, Verdict] = field(default_factory=dict)
    at: int = 0

    @classmethod
    def of(cls, graph: ScoredGraph, to_input: RigidMotion, path: Path, head: LabelHead) -> Queue:
        """The queue of a graph, at its first edge without a label in the file at `path`."""
        order = np.argsort(np.abs(graph.confidence - 0.5), kind="stable")
        queue = cls(graph=graph, to_input=to_input, path=path, head=head, order=order)
        if path.exists():
            number = {pair: n for n, pair in enumerate(map(tuple, graph.edges.tolist()))}
            queue.given = {
                number[label.edge]: (bool(label.valid), label.category)
                for label in read_labels(path).labels
                if label.edge in number
            }
        queue._go_on()
        return queue

    @property
    def edge(self) -> int:
        """The edge that is asked for."""
        return int(self.order[self.at])

    def say(self, valid: bool | None, category: Category | None) -> None:
        """Write down a verdict on the edge, None to take one back, and go on to the next."""
        edge = self.edge
        first, second = self.graph.edges[edge].tolist()
        places = self.to_input.apply(self.graph.xyz[[first, second]]).tolist()
        said = {"edge": (first, second), "xyz": places, "valid": valid, "category": category}
        label = EdgeLabel.model_validate(said)
        append_label(self.path, self.head, label)
        if valid is None:
            self.given.pop(edge, None)
            return
        self.given[edge] = (valid, category)
        self._go_on()

    def back(self) -> None:
        """The edge before."""
        self.at = max(self.at - 1, 0)

    def skip(self) -> None:
        """The next edge, labelled or not."""
        self.at = min(self.at + 1, len(self.order) - 1)

    def jump(self, edge: int) -> None:
        """Ask for this edge."""
        self.at = int(np.flatnonzero(self.order == edge)[0])

    def verdict(self, edge: int) -> str:
        """What was said of an edge, in words."""
        if edge not in self.given:
            return "not labelled"
        valid, category = self.given[edge]
        if not valid:
            return "not valid"
        return "valid" if category is None else f"valid, {category.replace('_', ' ')}"

    def _go_on(self) -> None:
        """To the next edge without a label; the last where there is none."""
        while self.at < len(self.order) - 1 and self.edge in self.given:
            self.at += 1
