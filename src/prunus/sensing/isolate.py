"""One tree out of a raw scan: without ground, posts, wires, neighbours and the row behind.

The paper's people did it by hand. Here a network sees every superpoint of the scan from the base
of one tree, and tells what it is to that tree; the points are what their superpoints are.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from prunus.errors import NoTreeError, PrunusError
from prunus.geometry.near import nearest
from prunus.geometry.pieces import components
from prunus.model import Bools, Floats, Ints, Kind, PointCloud, ScoredGraph
from prunus.networks import WEIGHTS, open_network
from prunus.params import Parameters
from prunus.sensing.isolated import Isolated
from prunus.sensing.surroundings import Pieces
from prunus.sensing.trunks import Trunk, find_trunks, foot_of
from prunus.stages.candidates import find_candidates
from prunus.stages.confidence import score_edges
from prunus.stages.networks import NetworkScorer
from prunus.stages.seeds import WEEDS_M
from prunus.stages.superpoints import find_superpoints

NETWORK = WEIGHTS / "isolate.onnx"
"""The isolation network, made by `prunus train --network isolation`."""
SHOWN = (frozenset({"node", "near", "link"}),)
TOLD = frozenset({"kind"})
POINTS = 50_000
"""So many points, drawn at random, are looked at."""
NODE_REACH = 0.15
"""A point is what the nearest superpoint is; a stray where none is so near, metres."""
AT_REACH = 0.50
"""A point given by hand lies so near to the scan, metres."""
SAME = 0.5
"""Two trees are one when they share so much of the smaller."""
CROWN, FOOT, TRUNKLESS = 1.5, 0.5, 0.1
"""A metre by which the wood of a tree, or its foot, is farther from the camera counts as so many
metres beside the middle of the scan; and so does a trunk that is not in view."""
CLOSE = 0.5
"""A tree so little farther aside, metres, could be meant as well."""
SNAPS = 0.25
"""A point given by hand means the trunk within so many metres."""
JOINS = 0.95
"""Edges of this confidence join wood."""


@dataclass(frozen=True, eq=False)
class Scene:
    """A scan as isolation sees it: superpoints, the superpoint of each point (P,), trunks."""

    cloud: PointCloud
    pieces: Pieces
    owner: Ints
    trunks: list[Trunk]

    @classmethod
    def of(cls, cloud: PointCloud, graph: ScoredGraph) -> Scene:
        """The scene of a cloud, from all candidate edges of points drawn from it."""
        owner = nearest(cloud.xyz, graph.xyz, NODE_REACH)
        return cls(cloud, Pieces.of(graph), owner, find_trunks(graph))

    def over(self, cloud: PointCloud) -> Scene:
        """The same scene with the points of all that was scanned."""
        return replace(self, cloud=cloud, owner=nearest(cloud.xyz, self.pieces.xyz, NODE_REACH))

    @cached_property
    def trees(self) -> list[Isolated]:
        """Every tree in view, no point in two, the one that is most likely meant first.

        That is the one nearest to the middle of the scan on the camera's side (smaller Y). A low
        end of a support that sees the tree of a trunk in view is part of that tree.
        """
        found: list[tuple[Floats, Floats]] = []
        for trunk in self.trunks:
            likely = self._likely(trunk.base)
            own = likely.argmax(axis=1) == Kind.TARGET
            seen = trunk.length == 0 and any(self._alike(own, other) for other, _ in found)
            if own.any() and not seen:
                found.append((likely, trunk.base))
        if not found:
            return []
        whose = np.argmax([likely[:, Kind.TARGET] for likely, _ in found], axis=0)
        trees = []
        for number, (likely, base) in enumerate(found):
            mine = likely.copy()
            mine[whose != number, Kind.TARGET] = 0
            trees.append(self._isolated(mine, base))
        return sorted((tree for tree in trees if tree.target.any()), key=self._aside)

    def _alike(self, own: Bools, likely: Floats) -> bool:
        """Whether a tree of these superpoints (N,) is much the same as another."""
        other = likely.argmax(axis=1) == Kind.TARGET
        return bool((own & other).sum() > SAME * min(own.sum(), other.sum()))

    def _aside(self, tree: Isolated) -> float:
        """How far a tree is from the middle of the scan and from the camera, less its share.

        The weights fit 140 simulated rows (97.9 % right) and the real scan.
        """
        low, high = np.percentile(self.pieces.xyz[:, 0], [2, 98])
        depth = self.cloud.xyz[tree.target, 1].mean()
        beside = abs(tree.foot[0] - (low + high) / 2)
        deeper = CROWN * depth + FOOT * tree.foot[1]
        trunkless = not any(one.length > 0 and one.base is tree.base for one in self.trunks)
        return float(beside + deeper + TRUNKLESS * trunkless - tree.target.mean())

    @property
    def rival(self) -> Floats | None:
        """The foot (3,) of the tree that could be meant as well as the first; None where none."""
        first, *others = self.trees
        close = others and self._aside(others[0]) < self._aside(first) + CLOSE
        return others[0].foot if close else None

    def tree_at(self, base: Floats) -> Isolated:
        """What each point is to the tree with that base (3,)."""
        return self._isolated(self._likely(base), base)

    def _kinds(self, tree: Isolated) -> Ints:
        """What each superpoint (N,) is to a tree, by its points."""
        kind = np.full(len(self.pieces.xyz), int(Kind.STRAY))
        kind[self.owner[self.owner >= 0]] = tree.kind[self.owner >= 0]
        return kind

    def linearity(self, tree: Isolated) -> float:
        """How much the median superpoint of a tree looks like a piece of a branch, 0 to 1."""
        own = self._kinds(tree) == Kind.TARGET
        return float(np.median(self.pieces.linear[own])) if own.any() else 0.0

    def torn(self, tree: Isolated) -> float:
        """How many superpoints were left out that sure edges join to a tree, for each of it."""
        kind = self._kinds(tree)
        own = kind == Kind.TARGET
        if not own.any():
            return 0.0
        piece = components(len(kind), self.pieces.edges[self.pieces.confidence >= JOINS])
        joined = piece == np.bincount(piece[own]).argmax()
        return float((joined & ~own & (kind != Kind.GROUND)).sum() / own.sum())

    def _likely(self, base: Floats) -> Floats:
        """The probability (N, kinds) of what each superpoint is to a tree."""
        seen = self.pieces.seen_from(base)
        told = {"node": seen.node, "near": seen.near, "link": seen.link}
        return np.array(open_network(NETWORK, SHOWN, TOLD).run(["kind"], told)[0], np.float64)

    def _isolated(self, likely: Floats, base: Floats) -> Isolated:
        kind = np.where(self.owner < 0, Kind.STRAY, likely.argmax(axis=1)[self.owner])
        return Isolated(kind, base, foot_of(self.cloud.xyz[kind == Kind.TARGET], base))


def look_at(cloud: PointCloud, params: Parameters, rng: np.random.Generator) -> Scene:
    """The scene of a scan. Raises PrunusError where no superpoint holds enough points."""
    return Scene.of(cloud, judged_graph(cloud, params, rng))


def judged_graph(cloud: PointCloud, params: Parameters, rng: np.random.Generator) -> ScoredGraph:
    """All candidate edges of points drawn from a cloud, as our network sees them."""
    superpoints = find_superpoints(cloud.sample(POINTS, rng), params.superpoints, rng)
    candidates = find_candidates(superpoints)
    return score_edges(candidates, NetworkScorer.shipped("ours"))


def isolate(scene: Scene, at: Floats | None) -> Isolated:
    """What each point of a scan is to the tree that stands at a point (3,) of the house frame.

    A trunk near the point is meant by it. None: the tree nearest to the middle of the scan on the
    camera's side. Raises PrunusError where no trunk is in view.
    """
    if at is None:
        if scene.trees:
            return replace(scene.tree_at(scene.trees[0].base), rival=scene.rival)
        raise NoTreeError("no trunk was found in the scan (--at X Y Z says where a tree stands)")
    beside = [_beside(trunk.base, at) for trunk in scene.trunks]
    meant = beside and min(beside) <= SNAPS
    return scene.tree_at(scene.trunks[int(np.argmin(beside))].base if meant else at)


def _beside(base: Floats, at: Floats) -> float:
    """How far a point is from a trunk, metres; weeds may hide the foot above it."""
    away = base - at
    away[2] -= np.clip(away[2], 0, WEEDS_M)
    return float(np.linalg.norm(away))


def check_at(scene: Scene, at: Floats) -> None:
    """Raise PrunusError where a point given by hand is far from all that the scan holds."""
    distance = np.linalg.norm(scene.pieces.xyz - at, axis=1)
    if distance.min() > AT_REACH:
        near = scene.cloud.to_input.apply(scene.pieces.xyz[distance.argmin()])
        raise PrunusError(
            f"the point given is {distance.min():.2f} m from the nearest part of the scan, "
            f"({near[0]:.2f}, {near[1]:.2f}, {near[2]:.2f}); expected at most {AT_REACH:.2f} m "
            "(it is in metres, in the frame of the input file)"
        )
