"""What the isolation network is shown: the superpoints of a scan from the base of one tree."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from prunus.geometry.pieces import cheapest
from prunus.model import Floats, Ints, ScoredGraph
from prunus.stages.context import Inputs, moments

LINKS = 10
"""A superpoint is told of so many others, those of its surest edges."""
FAR = 3.0
"""The way from the base counts as no longer, metres that are sure to be none of wood."""
DEAR = 0.02
"""Even a sure edge costs so much of its length on the way from the base."""
NODE_FEATURES = 23
LINK_FEATURES = 15


@dataclass(frozen=True, eq=False)
class Surroundings:
    """The superpoints N of a scan as seen from one base.

    node (N, NODE_FEATURES); near (N, LINKS): superpoints, itself where there is none; link
    (N, LINKS, LINK_FEATURES), the last of which says whether there is one.
    """

    node: Inputs
    near: Ints
    link: Inputs


@dataclass(frozen=True, eq=False)
class Pieces:
    """The superpoints N and candidate edges E of a scan, whichever tree is meant.

    xyz (N, 3) in the house frame; along (N, 3), where the points of each mostly run, upward;
    shape (N, 11): what does not change as the scan is turned; edges (E, 2), their confidence
    (E,) and category (E, 5); linked (N, LINKS): the surest edges of each, -1 = none.
    """

    xyz: Floats
    along: Floats
    shape: Floats
    edges: Ints
    confidence: Floats
    category: Floats
    linked: Ints

    @classmethod
    def of(cls, scored: ScoredGraph) -> Pieces:
        """The superpoints of a graph with all its candidate edges."""
        under = scored.candidates.superpoints
        spread, axes = np.linalg.eigh(moments(under))
        reach = spread.sum(axis=1)
        likely = scored.confidence[:, None] * scored.category
        kinds, best = np.zeros((len(under), likely.shape[1])), np.zeros(len(under))
        for end in (0, 1):
            np.add.at(kinds, scored.edges[:, end], likely / 3)
            np.maximum.at(best, scored.edges[:, end], scored.confidence)
        count = np.log1p(np.diff(under.start))
        parts = [spread[:, 2] / reach, spread[:, 1] / reach, 10 * np.sqrt(reach), 10 * under.wood]
        shape = np.column_stack([count, *parts, kinds, best])
        linked = surest(scored.edges, scored.confidence, len(under))
        edges, confidence, category = scored.edges, scored.confidence, scored.category
        return cls(under.xyz, upward(axes[:, :, 2]), shape, edges, confidence, category, linked)

    @property
    def linear(self) -> Floats:
        """How much each superpoint (N,) is a line: its spread along, less across, over along."""
        along, across = self.shape[:, 1], self.shape[:, 2]
        return np.asarray((along - across) / along)

    def turned(self, rotation: Floats) -> Pieces:
        """The same superpoints in a scan that was turned, or mirrored."""
        along = upward(self.along @ rotation.T)
        return replace(self, xyz=self.xyz @ rotation.T, along=along)

    def seen_from(self, base: Floats) -> Surroundings:
        """How all lies to the base (3,) of a tree."""
        away = self.xyz - base
        distance = np.linalg.norm(away, axis=1)
        way = self._ways(int(distance.argmin()))
        depth = self.xyz[:, 1] - np.percentile(self.xyz[:, 1], 5)
        height = self.xyz[:, 2] - np.percentile(self.xyz[:, 2], 2)
        place = [away, np.abs(away[:, 0]), height, depth, np.log(way + 0.01), way >= FAR, distance]
        node = np.column_stack([self.shape, self.along, *place])
        there = self.linked >= 0
        own = np.arange(len(self.xyz))[:, None]
        near = np.where(there, self.edges[self.linked].sum(axis=2) - own, own)
        step = self.xyz[near] - self.xyz[own]
        length = np.linalg.norm(step, axis=2)
        unit = step / np.maximum(length, 1e-6)[..., None]
        bends = [np.abs((unit * self.along[rows]).sum(axis=2)) for rows in (own, near)]
        sure = self.confidence[self.linked]
        odds = np.log((sure + 1e-6) / (1 - sure + 1e-6)) / 3
        farther = 10 * np.clip(way[near] - way[own], -0.3, 0.3)
        kinds = self.category[self.linked].transpose(2, 0, 1)
        steps = (10 * step).transpose(2, 0, 1)
        parts = [*steps, 10 * length, *bends, sure, odds, *kinds, farther]
        link = np.stack(parts, axis=2)
        link = np.concatenate([link * there[..., None], there[..., None]], axis=2)
        return Surroundings(node.astype(np.float32), near, link.astype(np.float32))

    def _ways(self, source: int) -> Floats:
        """What the cheapest way from a superpoint to each (N,) costs: metres of doubtful edges."""
        ends = self.xyz[self.edges]
        length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        cost = length * (1 + DEAR - self.confidence)
        return np.asarray(np.minimum(cheapest(len(self.xyz), self.edges, cost, source), FAR))


def surest(edges: Ints, confidence: Floats, nodes: int) -> Ints:
    """The edges (N, LINKS) of each node, the surest first; -1 = none."""
    order = np.argsort(-confidence, kind="stable")
    node, edge = edges[order].T.ravel(), np.tile(order, 2)
    rank = np.tile(np.arange(len(order)), 2)
    by_node = np.lexsort([rank, node])
    node, edge = node[by_node], edge[by_node]
    slot = np.arange(len(node)) - np.searchsorted(node, node)
    found = np.full((nodes, LINKS), -1)
    kept = slot < LINKS
    found[node[kept], slot[kept]] = edge[kept]
    return found


def upward(vectors: Floats) -> Floats:
    """The vectors (N, 3), those that point down turned round."""
    return np.asarray(vectors * np.where(vectors[:, 2:] < 0, -1.0, 1.0))
