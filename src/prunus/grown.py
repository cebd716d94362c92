"""The chain that votes and grows: a cloud in, the tree at which the scanner looks and its evidence.

Voxels, the point field, votes for the axes of branches, growth from the feet of all trees in view.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from prunus.errors import NoTreeError, PrunusError
from prunus.field.network import see_field
from prunus.field.votes import Threads, gather_votes
from prunus.field.voxels import Voxels, voxels_of
from prunus.growth.evidence import seeded_graph
from prunus.growth.grow import Orchard
from prunus.growth.told import told_of
from prunus.model import Floats, Ints, Kind, PointCloud, SeededGraph, Skeleton, Told
from prunus.params import Parameters
from prunus.result import Seconds, timed
from prunus.sensing.isolate import Isolated

MOST_POINTS = 100_000
"""So many points, drawn at random, show what the network can see."""
BASE_REACH_M = 0.30
"""A base that was given has a node so near,"""
WEEDS_M = 1.0
"""or straight above it, so far up: weeds may hide the wood between."""
BEHIND_M = 0.25
"""A tree that stands so much farther away is one behind."""
GROUND_M = 0.05
"""What is no wood and lies so little above the foot is ground."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Grown:
    """The tree, the graph of its threads, what the field told, what each point is, and notes."""

    skeleton: Skeleton
    graph: SeededGraph
    told: Told
    isolated: Isolated | None
    notes: list[str]


def grow_tree(
    cloud: PointCloud,
    at: Floats | None,
    params: Parameters,
    rng: np.random.Generator,
    seconds: Seconds,
) -> Grown:
    """The tree of a cloud that stands at a base (3,), or at which the scanner looks.

    NoTreeError where nothing is wood; PrunusError where the base is far from any.
    """
    with timed(seconds, "field"):
        drawn = cloud.sample(MOST_POINTS, rng)
        voxels = voxels_of(drawn.xyz)
        field = see_field(voxels)
    with timed(seconds, "votes"):
        threads = gather_votes(field)
    if len(threads) == 0:
        raise NoTreeError("no tree was found: nothing in the cloud looks like wood")
    with timed(seconds, "growth"):
        at, notes = _on_wood(threads, at, cloud)
        orchard = Orchard.of(threads, at, alone=params.isolation.isolate == "never")
        skeleton = orchard.tree_at(orchard.main)
        told = told_of(skeleton, orchard, field)
    with timed(seconds, "isolate"):
        isolated = Isolated(_kinds(cloud, voxels, orchard), skeleton.xyz[0], skeleton.xyz[0])
        raw = isolated.removed >= params.isolation.raw_from
        raw = {"auto": raw, "always": True, "never": False}[params.isolation.isolate]
        mine = np.ones(len(drawn), np.bool_)
        if raw:
            mine = orchard.foot_of_voxel()[voxels.of_point] == orchard.main
        graph = seeded_graph(drawn.take(mine), voxels.of_point[mine], voxels.xyz, orchard)
    if raw:
        notes.append(isolated.told())
    if at is None:
        place = cloud.words_for(skeleton.xyz[0])
        notes.append(f"no base was given: the foot of the trunk was found at {place}")
    isolated_or_none = isolated if raw else None
    return Grown(skeleton=skeleton, graph=graph, told=told, isolated=isolated_or_none, notes=notes)


def _on_wood(
    threads: Threads, at: Floats | None, cloud: PointCloud
) -> tuple[Floats | None, list[str]]:
    """The node nearest to a base that was given, or the lowest straight above it."""
    if at is None:
        return None, []
    away = threads.xyz - at
    distance = np.linalg.norm(away, axis=1)
    nearest = int(distance.argmin())
    if distance[nearest] <= BASE_REACH_M:
        return threads.xyz[nearest], []
    beside = np.linalg.norm(away[:, :2], axis=1)
    above = np.flatnonzero((beside <= BASE_REACH_M) & (away[:, 2] > 0) & (away[:, 2] <= WEEDS_M))
    shown = cloud.words_for(at)
    if len(above) == 0:
        raise PrunusError(
            f"the base {shown} is {distance[nearest]:.2f} m from the nearest wood; expected at "
            f"most {BASE_REACH_M:.2f} m (the base is in the frame and unit of the input file)"
        )
    lowest = int(above[away[above, 2].argmin()])
    note = f"the base {shown} is {away[lowest, 2]:.2f} m below the lowest wood in view"
    return threads.xyz[lowest], [f"{note}, which was taken"]


def _kinds(cloud: PointCloud, voxels: Voxels, orchard: Orchard) -> Ints:
    """What each point (P,) of a cloud is to the tree that is meant (`Kind`)."""
    row = voxels.holding(cloud.xyz)
    foot = np.where(row >= 0, orchard.foot_of_voxel()[row], -1)
    place = orchard.graph.threads.xyz
    base = place[orchard.main]
    behind = place[foot, 1] > base[1] + BEHIND_M
    kind = np.where(behind, int(Kind.BEHIND), int(Kind.NEIGHBOUR))
    kind[foot == orchard.main] = Kind.TARGET
    low = cloud.xyz[:, 2] < base[2] + GROUND_M
    kind[foot < 0] = np.where(low, int(Kind.GROUND), int(Kind.STRAY))[foot < 0]
    return kind
