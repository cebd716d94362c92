"""Vote and grow, the parts of the default: votes as evidence, and the tree that grows on them.

Voxels, the point field without wires, votes for the axes of branches, growth from the feet of all
trees in view.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import cKDTree

from prunus.errors import NoTreeError, PrunusError
from prunus.field.network import see_field
from prunus.field.votes import PointField, Threads, gather_votes
from prunus.field.voxels import Voxels, voxels_of
from prunus.field.wires import without_wires
from prunus.growth.belonging import likeliest
from prunus.growth.branches import Grown as Branches
from prunus.growth.branches import cut_branches
from prunus.growth.evidence import seeded_graph
from prunus.growth.graph import ThreadGraph, join_threads
from prunus.growth.grow import Choose, Cut, Orchard, Own, foot_ends
from prunus.growth.parents import choose_parents
from prunus.growth.told import SURE, lead_of, told_of
from prunus.growth.ways import Ways
from prunus.model import (
    Floats,
    Ints,
    Kind,
    PointCloud,
    SeededGraph,
    Skeleton,
    Told,
    parents_first,
)
from prunus.model.isolated import Isolated
from prunus.model.remarks import remarks
from prunus.params import Parameters
from prunus.result import Found, Seconds, timed

BASE_REACH_M = 0.30
"""A base that was given has a node so near,"""
WEEDS_M = 1.0
"""or straight above it, so far up: weeds may hide the wood between."""
BEHIND_M = 0.25
"""A tree that stands so much farther away is one behind."""
GROUND_M = 0.05
"""What is no wood and lies so little above the foot is ground."""
BESIDE_M = 0.05
"""A point that was not drawn, and wood too sparse to vote, go with what is so near at most."""


@dataclass(frozen=True, eq=False, kw_only=True)
class View:
    """A cloud, the points of it that were drawn, the field over their voxels, and all trees.

    `at` (3,): a base that was given; `notes`: what is to be said of it. Where the cloud is what was
    isolated of a scan, `raw` is the view of that scan, and `isolated` what its points are; `lead`:
    the least by which its tree led over others in view so far (`growth.told.lead_of`).
    """

    cloud: PointCloud
    drawn: PointCloud
    voxels: Voxels
    field: PointField
    orchard: Orchard
    at: Floats | None
    notes: list[str]
    raw: View | None = None
    isolated: Isolated | None = None
    lead: float = SURE

    def tree(self, cut: Cut = cut_branches, choose: Choose = choose_parents) -> Skeleton:
        """The tree that is meant."""
        return _by_nodes(self.orchard.tree_at(self.orchard.main, cut, choose))

    def graph(self, tree: Skeleton) -> SeededGraph:
        """The graph of the threads and of that tree, with its points if others were left out."""
        mine = np.ones(len(self.drawn), np.bool_)
        if self.isolated is not None:
            of_voxel = self.orchard.foot_of_voxel()
            mine = of_voxel[self.voxels.of_point] == self.orchard.main
        points, of_voxel = self.drawn.take(mine), self.voxels.of_point[mine]
        return seeded_graph(points, of_voxel, self.voxels.xyz, self.orchard, tree)

    def told(self, tree: Skeleton) -> Told:
        """What the field tells of a tree; what stood around it is told by the raw scan."""
        lead = SURE if self.at is not None else self.leads()
        return told_of(tree, self.orchard, self.field, (self.raw or self).field, lead)

    def leads(self) -> float:
        """By how much the tree that is meant leads over others, at the least so far."""
        return min(self.lead, lead_of(self.orchard))

    def meant_at(self, place: Floats) -> View:
        """The same view; the tree is meant whose foot is the nearest to a place (3,)."""
        feet = self.orchard.feet
        away = np.linalg.norm(self.orchard.graph.threads.xyz[feet] - place, axis=1)
        return replace(self, orchard=replace(self.orchard, main=int(feet[away.argmin()])))

    def each(self) -> list[View]:
        """The view with each tree in turn as the one that is meant, that which is so first."""
        main = self.orchard.main
        feet = sorted(self.orchard.feet.tolist(), key=lambda foot: foot != main)
        return [replace(self, orchard=replace(self.orchard, main=foot)) for foot in feet]

    def points_of_tree(self) -> Isolated:
        """What each point of the cloud is to the tree that is meant."""
        threads, main = self.orchard.graph.threads, self.orchard.main
        foot = self._foot_of_points()
        place = threads.xyz
        behind = place[foot, 1] > place[main, 1] + BEHIND_M
        kind = np.where(behind, int(Kind.BEHIND), int(Kind.NEIGHBOUR))
        kind[foot == main] = Kind.TARGET
        low = self.cloud.xyz[:, 2] < place[main, 2] + GROUND_M
        kind[foot < 0] = np.where(low, int(Kind.GROUND), int(Kind.STRAY))[foot < 0]
        return Isolated(kind, self.orchard.place_of(main))

    def _foot_of_points(self) -> Ints:
        """The foot (P,) of the tree that each point of the cloud is wood of; -1 = of none."""
        foot = self.orchard.foot_of_voxel()
        lone, owned = np.flatnonzero(self.field.wood & (foot < 0)), np.flatnonzero(foot >= 0)
        voxel = self.voxels.xyz
        foot[lone] = _of_the_nearest(voxel[lone], voxel[owned], foot[owned])
        row = self.voxels.holding(self.cloud.xyz)
        of_point = foot[row]
        between = np.flatnonzero(row < 0)
        of_point[between] = _of_the_nearest(self.cloud.xyz[between], voxel, foot)
        return of_point


@dataclass(frozen=True, kw_only=True)
class Votes:
    """The evidence that votes give; each part can be replaced by another of its kind.

    see: voxels to the point field; clean: the field without what is no wood though it looks like
    it, wires; vote: field to threads; join: threads, and the longest gap in metres, to a graph;
    own: to which of the feet of trees in view each node belongs.
    """

    see: Callable[[Voxels], PointField] = see_field
    clean: Callable[[PointField, np.random.Generator], PointField] = without_wires
    vote: Callable[[PointField], Threads] = gather_votes
    join: Callable[[Threads, float], ThreadGraph] = join_threads
    own: Own = likeliest

    def __call__(
        self,
        cloud: PointCloud,
        at: Floats | None,
        params: Parameters,
        rng: np.random.Generator,
        seconds: Seconds,
    ) -> View:
        """The tree of a cloud that stands at a base (3,), or at which the scanner looks.

        NoTreeError where nothing is wood; PrunusError where the base is far from any.
        """
        return self.alone(self.look(cloud, at, params, rng, seconds), params, rng, seconds)

    def look(
        self,
        cloud: PointCloud,
        at: Floats | None,
        params: Parameters,
        rng: np.random.Generator,
        seconds: Seconds,
    ) -> View:
        """A cloud with all that is in it; errors as for a call."""
        rng = deepcopy(rng)  # so that a tree is seen alike in its own file
        with timed(seconds, "field"):
            drawn = cloud.sample_evenly(params.input.count, rng)
            voxels = voxels_of(drawn.xyz)
            field = self.clean(self.see(voxels), rng)
        with timed(seconds, "votes"):
            threads = self.vote(field)
        if len(threads) == 0:
            raise NoTreeError("no tree was found: nothing in the cloud looks like wood")
        with timed(seconds, "growth"):
            base, notes = _on_wood(threads, at, cloud)
            graph = self.join(threads, params.growth.gap_max)
            alone = params.isolation.isolate == "never"
            orchard = Orchard.of(graph, base, alone, self.own)
        return View(
            cloud=cloud, drawn=drawn, voxels=voxels, field=field, orchard=orchard, at=at,
            notes=notes,
        )  # fmt: skip

    def alone(
        self, raw: View, params: Parameters, rng: np.random.Generator, seconds: Seconds
    ) -> View:
        """The tree that is meant without what is none of it, seen anew until nothing more is.

        So what is isolated, written and read again is the same tree.
        """
        view, kind = raw, np.full(len(raw.cloud), int(Kind.TARGET))
        while True:
            with timed(seconds, "isolate"):
                isolated = asked_for(view.points_of_tree(), params, again=view is not raw)
            if isolated is None:
                return view
            kind[kind == Kind.TARGET] = isolated.kind
            isolated = Isolated(kind.copy(), isolated.foot)
            own = raw.cloud.take(isolated.target)
            nearer = self.look(own, raw.at, params, rng, seconds).meant_at(isolated.foot)
            view = replace(nearer, raw=raw, isolated=isolated, lead=view.leads())


@dataclass(frozen=True, kw_only=True)
class Growth:
    """The tree that grows on that evidence; each part can be replaced by another of its kind.

    cut: which branches grow from a foot, none shorter than two lengths in metres, of branches and
    of what looks like a spur; choose: on what they hang, and their labels.
    """

    cut: Callable[[Threads, Ways, int, float, float], Branches] = cut_branches
    choose: Choose = choose_parents

    def __call__(
        self, view: View, params: Parameters, rng: np.random.Generator, seconds: Seconds
    ) -> Found:
        """The tree that is meant, what the field told of it, and what of the cloud is not it."""
        isolated = view.isolated
        with timed(seconds, "growth"):
            skeleton = view.tree(self._cut_by(params), self.choose)
            told, graph = view.told(skeleton), view.graph(skeleton)
        notes = view.notes if isolated is None else [*view.notes, isolated.told()]
        if view.at is None:
            place = view.cloud.words_for(skeleton.xyz[0])
            notes = [*notes, f"no base was given: the foot of the trunk was found at {place}"]
        with timed(seconds, "measures"):
            warnings = remarks(skeleton, graph, for_tips=False)
        return Found(
            skeleton=skeleton, graph=graph, warnings=warnings, notes=notes, isolated=isolated,
            told=told,
        )  # fmt: skip

    def _cut_by(self, params: Parameters) -> Cut:
        least = params.growth.branch_min, params.growth.spur_min
        return lambda threads, ways, foot: self.cut(threads, ways, foot, *least)


def isolated_tree(
    cloud: PointCloud,
    at: Floats | None,
    params: Parameters,
    rng: np.random.Generator,
    seconds: Seconds,
) -> Isolated | None:
    """What each point of a scan is to the tree that is meant; None where nothing is to be left out.

    Errors are those of `Votes`.
    """
    if params.isolation.isolate == "never":
        return None
    return Votes()(cloud, at, params, rng, seconds).isolated


def asked_for(isolated: Isolated, params: Parameters, again: bool = False) -> Isolated | None:
    """What was isolated, where the scan is raw enough for what is asked; `again`: once more."""
    raw = isolated.removed >= params.isolation.raw_from
    wanted = {"auto": raw, "always": raw or not again, "never": False}[params.isolation.isolate]
    return isolated if wanted else None


def _of_the_nearest(xyz: Floats, others: Floats, foot: Ints) -> Ints:
    """The foot (P,) of the nearest of others (V, 3) that lies beside each of some points (P, 3)."""
    if len(others) == 0:
        return np.full(len(xyz), -1)
    away, row = cKDTree(others).query(xyz, distance_upper_bound=BESIDE_M)
    return np.where(np.isfinite(away), foot[np.minimum(row, len(foot) - 1)], -1)


def _by_nodes(tree: Skeleton) -> Skeleton:
    """The same tree with what hangs on one node in the order of nodes, as corrections have it."""
    node = tree.superpoint
    above = {int(node[row]): int(node[tree.parent[row]]) for row in range(1, len(tree))}
    order, parent = parents_first(int(node[0]), dict(sorted(above.items())))
    row_of = {one: row for row, one in enumerate(node.tolist())}
    row = np.array([row_of[one] for one in order])
    return Skeleton.build(
        tree.xyz[row], parent, tree.label[row], confidence=tree.confidence[row],
        radius=tree.radius[row], superpoint=order,
    )  # fmt: skip


def _on_wood(
    threads: Threads, at: Floats | None, cloud: PointCloud
) -> tuple[Floats | None, list[str]]:
    """The node nearest to a base that was given, or the lowest straight above it."""
    if at is None:
        return None, []
    away = threads.xyz - at
    # The base of a skeleton is where the wood of its foot ends: given again, it is that foot.
    ends = foot_ends(threads, np.arange(len(threads)))
    distance = np.minimum(*(np.linalg.norm(place - at, axis=1) for place in (threads.xyz, ends)))
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
