"""From threads to a tree: graph, feet, ways, branches, parents and labels."""

from __future__ import annotations

from prunus.field.votes import Threads
from prunus.growth.branches import cut_branches
from prunus.growth.feet import find_feet, main_foot, nearest_foot
from prunus.growth.graph import join_threads
from prunus.growth.parents import choose_parents
from prunus.growth.ways import find_ways
from prunus.model import Floats, Skeleton


def grow(threads: Threads, base: Floats | None = None) -> Skeleton:
    """The tree of some threads: of that at `base` (3,), or of that at which the scanner looks."""
    graph = join_threads(threads)
    feet = find_feet(graph, None if base is None else nearest_foot(threads, base))
    ways = find_ways(graph, feet)
    foot = main_foot(threads, ways.foot, feet) if base is None else int(feet[0])
    grown = cut_branches(threads, ways, foot)
    grown, told = choose_parents(threads, grown)
    nodes = grown.nodes
    return Skeleton.build(
        threads.xyz[nodes], grown.parent, told.label, radius=threads.radius[nodes], superpoint=nodes
    )
