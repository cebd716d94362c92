"""From threads to trees: graph, feet, ways, branches, parents and labels."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from prunus.field.votes import Threads
from prunus.growth.belonging import likeliest
from prunus.growth.branches import Grown, cut_branches
from prunus.growth.feet import find_feet, main_foot, nearest_foot
from prunus.growth.graph import ThreadGraph, confidence_of
from prunus.growth.labels import Labelled
from prunus.growth.parents import choose_parents
from prunus.growth.ways import Ways, cheapest, find_ways
from prunus.model import Floats, Ints, Skeleton

Own = Callable[[ThreadGraph, Ints], Ints]
"""To which of the feet (F,) each node (N,) belongs."""
Cut = Callable[[Threads, Ways, int], Grown]
"""Which branches grow from a foot."""
Choose = Callable[[Threads, Grown], tuple[Grown, Labelled]]
"""On what they hang, and their labels."""
MOST_M = 0.05
"""An end is moved by so much at most."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Orchard:
    """All trees in view: each node of the threads grows from the foot of its tree.

    feet (F,) are nodes; `main` is that of the tree that is meant.
    """

    graph: ThreadGraph
    feet: Ints
    ways: Ways
    main: int

    @classmethod
    def of(
        cls,
        graph: ThreadGraph,
        base: Floats | None = None,
        alone: bool = False,
        own: Own = likeliest,
    ) -> Orchard:
        """The trees of some threads; meant is that at `base` (3,), or at which the scanner looks.

        Threads hold one node at least. `alone`: all is one tree; else `own` tells whose wood is.
        """
        threads = graph.threads
        feet = find_feet(graph, None if base is None else nearest_foot(threads, base))
        own = cheapest if alone else own
        ways = find_ways(graph, feet, own(graph, feet))
        main = main_foot(threads, ways.foot, feet) if base is None else int(feet[0])
        if alone:
            feet = np.array([main])
            ways = find_ways(graph, feet, own(graph, feet))
        return cls(graph=graph, feet=feet, ways=ways, main=main)

    def tree_at(
        self, foot: int, cut: Cut = cut_branches, choose: Choose = choose_parents
    ) -> Skeleton:
        """The labelled tree that grows from a foot."""
        threads = self.graph.threads
        grown, told = choose(threads, cut(threads, self.ways, foot))
        nodes = grown.nodes
        edges = np.column_stack([nodes[np.maximum(grown.parent, 0)], nodes])
        confidence = np.append(np.nan, confidence_of(threads, edges[1:]))
        return Skeleton.build(
            _to_the_ends(threads, grown), grown.parent, told.label,
            confidence=confidence, radius=threads.radius[nodes], superpoint=nodes,
        )  # fmt: skip

    def place_of(self, foot: int) -> Floats:
        """Where the wood of a foot ends (3,)."""
        return np.asarray(foot_ends(self.graph.threads, np.array([foot]))[0])

    def foot_of_voxel(self) -> Ints:
        """The foot (V,) of the tree that each voxel of the field is wood of; -1 = of none."""
        of_voxel = self.graph.threads.of_voxel
        return np.where(of_voxel >= 0, self.ways.foot[of_voxel], -1)


def _to_the_ends(threads: Threads, grown: Grown) -> Floats:
    """The places (M, 3) of the nodes of a tree, its tips and its foot where the wood ends.

    Votes at an end lie inside of it: each is the mean of those around.
    """
    nodes = grown.nodes
    xyz, beyond = threads.xyz[nodes], np.minimum(threads.beyond[nodes, 0], MOST_M)
    tips = np.setdiff1d(np.arange(1, len(nodes)), grown.parent)
    xyz[tips] -= beyond[tips, None] * threads.toward_foot[nodes[tips]]
    xyz[0] = foot_ends(threads, nodes[:1])[0]
    return np.asarray(xyz)


def foot_ends(threads: Threads, nodes: Ints) -> Floats:
    """Where the wood of nodes (N,) ends toward the foot (N, 3)."""
    beyond = np.minimum(threads.beyond[nodes, 1:], MOST_M)
    return np.asarray(threads.xyz[nodes] + beyond * threads.toward_foot[nodes])
