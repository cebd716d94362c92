"""The feet of the trees in view: the low ends of what is stem."""

from __future__ import annotations

import numpy as np
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import cKDTree

from prunus.field.votes import Threads
from prunus.geometry.pieces import components
from prunus.growth.graph import ThreadGraph
from prunus.model import Floats, Ints, Role

LEAST_STEM = 0.4
"""Probability of stem from which a node is one."""
STEM_APART_M = 0.08
"""Parts of one stem lie so close."""
LEAST_STEM_M = 0.06
"""A stem is at least so long."""
LEAST_WOOD_M = 0.5
"""So much wood flows to an end that may be the foot of another tree."""
FLOWS_COS = 0.5
"""The cosine between the direction of a node and the way to the one before it, at least."""
AGAINST_M, STEM_AGAINST_M = 0.5, 0.15
"""Another tree is one to whose foot every way goes so far against the flow of the wood, and one
whose stem is in view."""
ALIKE_M = 0.02
"""Ways that differ by less in that are alike."""
MUCH, ASIDE, FAR_ASIDE, BEHIND, FOOT_BEHIND = 0.53, 1.2, 1.15, 1.6, 1.0
"""How much likelier (log odds) a tree is meant for e times the wood; how much less for a metre from
the middle of the view, and for the square of that; for a metre that its wood is behind that of the
foremost, and its foot."""
SCRAP, NOT_A_SCRAP = 0.1, 10.0
"""What has so small a share of the wood of the largest is a scrap, and that is much less likely."""


def find_feet(graph: ThreadGraph, given: int | None = None) -> Ints:
    """The nodes (F,) where trees stand, those with most stem first; the lowest end where none is.

    A foot is the end of a stem to which its directions point, and to which no other tree leads. One
    that was given is the first.
    """
    threads = graph.threads
    stem = np.flatnonzero(threads.role[:, Role.STEM] >= LEAST_STEM)
    piece = components(len(stem), _pairs(threads.xyz[stem], STEM_APART_M))
    found = [_low_end(threads, stem[piece == one]) for one in np.unique(piece)]
    ends = [(-mass, node) for node, mass, length in found if length >= LEAST_STEM_M]
    feet = [node for _, node in sorted(ends)]
    limit = [STEM_AGAINST_M] * len(feet)
    feet += [end for end in ends_of_flow(graph) if end not in feet]
    limit += [AGAINST_M] * (len(feet) - len(limit))
    own = _own_feet(graph, feet, np.array(limit)) if feet else _lowest(graph)
    return own if given is None else _with(graph, given, own)


def ends_of_flow(graph: ThreadGraph) -> list[int]:
    """Where wood of which enough is in view goes on unseen: the most wood first.

    Every node leads to the one before it that its direction points to; where none does, the flow
    of the wood ends. That is a foot, or where a tree comes into view whose foot is not.
    """
    size = len(graph.threads)
    near = ~np.tile(graph.gap, 2)
    outward, cost = graph.outward[near], graph.costs[near]
    way = graph.threads.xyz[outward[:, 0]] - graph.threads.xyz[outward[:, 1]]
    along = (way * graph.threads.toward_foot[outward[:, 1]]).sum(axis=1)
    ahead = along > FLOWS_COS * np.linalg.norm(way, axis=1)
    toward_foot = graph.threads.toward_foot
    ahead &= (toward_foot[outward[:, 0]] * toward_foot[outward[:, 1]]).sum(axis=1) > -FLOWS_COS
    outward, cost = outward[ahead], cost[ahead]
    order = np.lexsort((-cost, outward[:, 1]))
    before = np.arange(size)
    before[outward[order, 1]] = outward[order, 0]  # the cheapest comes last
    end = before
    for _ in range(size.bit_length()):
        end = end[end]
    wood = np.bincount(end, np.linalg.norm(graph.threads.xyz - graph.threads.xyz[before], axis=1))
    found = np.flatnonzero((wood >= LEAST_WOOD_M) & (before[: len(wood)] == np.arange(len(wood))))
    order = np.argsort(-wood[found], kind="stable")
    return [int(end) for end in found[order]]


def _pairs(xyz: Floats, reach: float) -> Ints:
    """The pairs (E, 2) of points that lie so close."""
    if len(xyz) == 0:
        return np.zeros((0, 2), np.int64)
    return np.asarray(cKDTree(xyz).query_pairs(reach, output_type="ndarray"), np.int64)


def _own_feet(graph: ThreadGraph, feet: list[int], limit: Floats) -> Ints:
    """Those feet that wood does not lead to from another, by going against the flow less than that.

    To the foot of another tree a way goes down its trunk; to a part of the same tree it only
    crosses a gap. Of two that lead to each other the one stays from which it is easier; the first,
    where they are alike.
    """
    against = dijkstra(graph.against, indices=feet, limit=AGAINST_M)[:, feet]
    rank = np.arange(len(feet))
    easier = (against < against.T - ALIKE_M) | (
        (against < against.T + ALIKE_M) & (rank[:, None] < rank)
    )
    led_to = ((against <= limit) & easier).any(axis=0)
    led_to[0] &= not led_to.all()  # in a circle, as on a ball, each leads to the next
    return np.asarray(np.array(feet)[~led_to], np.int64)


def _with(graph: ThreadGraph, given: int, feet: Ints) -> Ints:
    """One that was given, and the feet of the other trees: all but that of its own tree."""
    _, _, owner = dijkstra(graph.belonging, indices=feet, min_only=True, return_predecessors=True)
    down = dijkstra(graph.against, indices=given, limit=AGAINST_M)
    own = (feet == owner[given]) & np.isfinite(down[feet])
    return np.append(given, feet[~own & (feet != given)])


def _low_end(threads: Threads, nodes: Ints) -> tuple[int, float, float]:
    """The node of a stem that lies farthest toward its foot, its votes, and its length."""
    direction = threads.toward_foot[nodes].sum(axis=0)
    direction /= max(float(np.linalg.norm(direction)), 1e-9)
    along = threads.xyz[nodes] @ direction
    return int(nodes[along.argmax()]), float(threads.votes[nodes].sum()), float(np.ptp(along))


def main_foot(threads: Threads, foot: Ints, feet: Ints) -> int:
    """Of the trees in view that at which the scanner looks; `foot` (N,) is that of each node."""
    return int(feet[standing(threads, foot, feet).argmax()])


def standing(threads: Threads, foot: Ints, feet: Ints) -> Floats:
    """How much speaks (F,), in log odds, for the tree of each of the feet as the one meant.

    It stands in the middle and in front, and much of it is in view (a conditional logit).
    """
    own = foot == feet[:, None]
    voxels = np.bincount(threads.of_voxel[threads.of_voxel >= 0], minlength=len(threads))
    points = threads.votes**2 / np.maximum(voxels, 1)
    wood = own @ points
    middle = np.ptp(threads.xyz[:, 0]) / 2 + threads.xyz[:, 0].min()
    aside = np.abs(threads.xyz[feet, 0] - middle)
    depth = own @ (points * threads.xyz[:, 1]) / np.maximum(wood, 1e-9)
    chance = MUCH * np.log1p(wood) - ASIDE * aside - FAR_ASIDE * aside**2
    chance -= BEHIND * depth + FOOT_BEHIND * threads.xyz[feet, 1]
    return np.asarray(np.where(wood < SCRAP * wood.max(), chance - NOT_A_SCRAP, chance))


def _lowest(graph: ThreadGraph) -> Ints:
    """The lowest node of the piece with most votes."""
    threads = graph.threads
    if len(threads) == 0:
        return np.zeros(0, np.int64)
    piece = components(len(threads), graph.edges)
    largest = np.flatnonzero(piece == np.bincount(piece, threads.votes).argmax())
    return largest[[threads.xyz[largest, 2].argmin()]]


def nearest_foot(threads: Threads, base: Floats) -> int:
    """The node nearest to a base (3,) that was given."""
    return int(threads.tree.query(base)[1])
