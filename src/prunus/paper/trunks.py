"""The trunks in a scan, and where each meets the ground or leaves what the scan holds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from prunus.geometry.pieces import components
from prunus.model import Floats, Ints, Label, PointCloud, ScoredGraph

SURE = 0.30
"""Edges of this confidence hold a trunk together."""
LIKELY = 0.35
"""Edges are trunk from this probability on."""
LEAST = 0.08
"""A trunk of fewer metres is none."""
THICK = 0.35
"""Where no trunk is in view: low ends of wood that is support by so much, or trunk."""
APART = 0.40
"""Two trees stand at least so far apart, metres."""


@dataclass(frozen=True, eq=False)
class Trunk:
    """Where a tree may stand: its lowest superpoint base (3,), and the metres of trunk in view."""

    base: Floats
    length: float


def find_trunks(scored: ScoredGraph) -> list[Trunk]:
    """Where trees may stand in a graph, the longest trunk first, then low ends of supports.

    A short trunk may be hidden, or look like the support that it bends into.
    """
    if scored.category.size == 0:
        return []
    found = _trunks(scored)
    for node in _low_ends(scored):
        beside = [np.linalg.norm((one.base - scored.xyz[node])[:2]) for one in found]
        if min(beside, default=np.inf) > APART:
            found.append(Trunk(scored.xyz[node], 0.0))
    return found


def _trunks(scored: ScoredGraph) -> list[Trunk]:
    """The pieces that edges of trunk hold together, the longest first."""
    trunk = scored.category[:, Label.TRUNK]
    held = (scored.confidence >= SURE) & (trunk >= LIKELY)
    edges = scored.edges[held]
    ends = scored.xyz[edges]
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) * (scored.confidence * trunk)[held]
    piece = components(len(scored.xyz), edges)
    total = np.bincount(piece[edges[:, 0]], length, len(piece))
    found = []
    for number in np.flatnonzero(total >= LEAST):
        nodes = np.flatnonzero(piece == number)
        lowest = nodes[scored.xyz[nodes, 2].argmin()]
        found.append(Trunk(scored.xyz[lowest], float(total[number])))
    return sorted(found, key=lambda one: -one.length)


def _low_ends(scored: ScoredGraph) -> Ints:
    """Superpoints of thick wood with no lower wood about them, the lowest first."""
    sure = scored.confidence >= SURE
    ends = scored.edges[sure].T.ravel()
    thick = scored.category[sure][:, [Label.TRUNK, Label.SUPPORT]].sum(axis=1)
    count = np.bincount(ends, minlength=len(scored.xyz))
    share = np.bincount(ends, np.tile(thick, 2), len(scored.xyz)) / np.maximum(count, 1)
    wood = np.flatnonzero(count)
    found = []
    for node in np.flatnonzero(share >= THICK):
        beside = np.linalg.norm((scored.xyz[wood] - scored.xyz[node])[:, :2], axis=1) <= APART
        if scored.xyz[wood[beside], 2].min() >= scored.xyz[node, 2]:
            found.append(node)
    order = np.argsort(scored.xyz[found, 2], kind="stable")
    return np.asarray(found, np.int64)[order]


def find_foot(cloud: PointCloud, scored: ScoredGraph) -> Floats | None:
    """Where the trunk of a tree (its points alone) stands (3,); None where no trunk is in view."""
    trunks = find_trunks(scored)
    return foot_of(cloud.xyz, trunks[0].base) if trunks else None


def on_wood(foot: Floats | None, scored: ScoredGraph) -> Floats | None:
    """A foot (3,) that was found, if sure wood is there; else the nearest superpoint of such.

    None where there is none, or no foot was found.
    """
    wood = np.unique(scored.edges[scored.confidence >= SURE])
    if foot is None or len(wood) == 0:
        return None
    away = np.linalg.norm(scored.xyz[wood] - foot, axis=1)
    return foot if away.min() <= FOOT_REACH_M else np.asarray(scored.xyz[wood[away.argmin()]])


FOOT_REACH_M = 0.15
"""The foot of a trunk is so near to a superpoint of its wood."""


def foot_of(points: Floats, base: Floats) -> Floats:
    """The lowest point (3,) of a trunk's axis, from the points (P, 3) of its tree alone.

    A camera sees the front of a trunk: its axis lies behind that by half its width. `base` is
    about there; it comes back where few points are near.
    """
    beside = np.linalg.norm((points - base)[:, :2], axis=1) < BESIDE
    near = points[beside & (np.abs(points[:, 2] - base[2]) < REACH)]
    if len(near) < FEW:
        return base
    lowest = np.sort(near[:, 2])[LOWEST] - SPARE
    slab = near[near[:, 2] < lowest + SLAB]
    left, right = np.quantile(slab[:, 0], [FRONT, 1 - FRONT])
    depth = np.quantile(slab[:, 1], FRONT) + DEPTH * (right - left) / 2
    return np.array([np.median(slab[:, 0]), depth, lowest])


BESIDE, REACH = 0.12, 0.25
"""Points so far beside the lowest superpoint of a trunk, and above or below it, are looked at."""
FEW, LOWEST = 20, 3
"""Of fewer points nothing is told; a few may lie lower than the trunk."""
SLAB, SPARE = 0.07, 0.012
"""The lowest so many metres say where the axis is; the foot is so much lower than its points."""
FRONT, DEPTH = 0.10, 1.3
"""The front has so large a share of the points before it; the axis is so many half widths on."""
