"""The feet of the trees in view: the low ends of what is stem."""

from __future__ import annotations

import numpy as np
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import cKDTree

from prunus.field.votes import Threads
from prunus.growth.graph import ThreadGraph, pieces_of
from prunus.model import Floats, Ints, Role

LEAST_STEM = 0.4
"""Probability of stem from which a node is one."""
STEM_APART_M = 0.08
"""Parts of one stem lie so close."""
LEAST_STEM_M = 0.06
"""A stem is at least so long."""
LEADS_TO = 6.0
"""A foot to which one may grow from another at this cost, metres, is wood of that tree."""


def find_feet(graph: ThreadGraph, given: int | None = None) -> Ints:
    """The nodes (F,) where trees stand, those with most stem first; the lowest end where none is.

    A foot is the end of a stem to which its directions point, and to which no other tree leads. One
    that was given is the first.
    """
    threads = graph.threads
    stem = np.flatnonzero(threads.role[:, Role.STEM] >= LEAST_STEM)
    piece = pieces_of(len(stem), _pairs(threads.xyz[stem], STEM_APART_M))
    found = [_low_end(threads, stem[piece == one]) for one in range(piece.max(initial=-1) + 1)]
    ends = [(-mass, node) for node, mass, length in found if length >= LEAST_STEM_M]
    feet = [node for _, node in sorted(ends)]
    feet = feet if given is None else [given, *feet]
    return _own_feet(graph, feet) if feet else _lowest(graph)


def _pairs(xyz: Floats, reach: float) -> Ints:
    """The pairs (E, 2) of points that lie so close."""
    if len(xyz) == 0:
        return np.zeros((0, 2), np.int64)
    return np.asarray(cKDTree(xyz).query_pairs(reach, output_type="ndarray"), np.int64)


def _own_feet(graph: ThreadGraph, feet: list[int]) -> Ints:
    """Those feet that wood does not lead to from one with more stem.

    To come to the foot of another tree, a way goes down its trunk against the flow, which is dear.
    """
    own: list[int] = []
    for foot in feet:
        if not own or dijkstra(graph.matrix, indices=own, min_only=True)[foot] > LEADS_TO:
            own.append(foot)
    return np.array(own)


def _low_end(threads: Threads, nodes: Ints) -> tuple[int, float, float]:
    """The node of a stem that lies farthest toward its foot, its votes, and its length."""
    direction = threads.toward_foot[nodes].sum(axis=0)
    direction /= max(float(np.linalg.norm(direction)), 1e-9)
    along = threads.xyz[nodes] @ direction
    return int(nodes[along.argmax()]), float(threads.votes[nodes].sum()), float(np.ptp(along))


def _lowest(graph: ThreadGraph) -> Ints:
    """The lowest node of the piece with most votes."""
    threads = graph.threads
    if len(threads) == 0:
        return np.zeros(0, np.int64)
    piece = pieces_of(len(threads), graph.edges)
    largest = np.flatnonzero(piece == np.bincount(piece, threads.votes).argmax())
    return largest[[threads.xyz[largest, 2].argmin()]]


def nearest_foot(threads: Threads, base: Floats) -> int:
    """The node nearest to a base (3,) that was given."""
    return int(cKDTree(threads.xyz).query(base)[1])
