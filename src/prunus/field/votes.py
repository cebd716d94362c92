"""Votes for the axes of branches: what was a fat or one-sided surface becomes thin threads.

Each voxel of wood moves by the offset that the network predicts (medial-axis voting, as VoteNet
votes for centres). One step of mean shift draws the votes together, and a maximal independent set
of them, the densest first, stands for the rest.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import csr_array
from scipy.spatial import cKDTree

from prunus.geometry.vectors import unit
from prunus.model import Bools, Floats, Ints, Role

LEAST_WOOD = 0.5  # probability of wood from which a voxel votes
SHIFT_M = 0.02  # bandwidth of the mean shift
LONELY_M, LEAST_VOTES = 0.03, 3.0  # fewer votes (weights) so near to one are noise,
LEAST_SHARE, ENOUGH_VOTES = 0.2, 8.0  # and fewer than this share of what is usual, or than enough;
SPARSE = 0.5  # where few are usual, fewer than this share of that
APART_M = 0.012  # distance of the nodes that stand for the votes
ALIKE_COS = 0.5  # votes whose directions differ more are of two branches that touch or cross
LEAST_CHANCE = 1e-3  # probabilities below are taken for it when their logarithms are averaged


@dataclass(frozen=True, eq=False, kw_only=True)
class PointField:
    """What is said of each of V voxels.

    xyz (V, 3), metres; count (V,) of points; role (V, 6), probabilities in the order of `Role`;
    offset (V, 3) to the axis of its branch, metres; radius (V,) of that, metres; toward_foot
    (V, 3), the unit direction of that axis to the foot of the tree.
    """

    xyz: Floats
    count: Ints
    role: Floats
    offset: Floats
    radius: Floats
    toward_foot: Floats

    @property
    def wood(self) -> Bools:
        """Which voxels (V,) are wood."""
        return np.asarray(1 - self.role[:, Role.NO_WOOD] >= LEAST_WOOD)

    def take(self, rows: Ints | Bools) -> PointField:
        """The field of these voxels only."""
        return PointField(
            xyz=self.xyz[rows],
            count=self.count[rows],
            role=self.role[rows],
            offset=self.offset[rows],
            radius=self.radius[rows],
            toward_foot=self.toward_foot[rows],
        )


@dataclass(frozen=True, eq=False, kw_only=True)
class Threads:
    """N nodes on the axes of branches, about 12 mm apart.

    xyz (N, 3); role (N, 6), probabilities; radius (N,), metres; toward_foot (N, 3), unit; votes
    (N,), the root of the points of each voxel, summed; scatter (N,), how far its votes lie from
    it, metres; beyond (N, 2), how far the voxels that voted for it lie outward of it and toward the
    foot, metres; of_voxel (V,), the node for which each voxel of the field voted, -1 = none.
    """

    xyz: Floats
    role: Floats
    radius: Floats
    toward_foot: Floats
    votes: Floats
    scatter: Floats
    beyond: Floats
    of_voxel: Ints

    def __len__(self) -> int:
        return len(self.xyz)

    @cached_property
    def tree(self) -> cKDTree:
        """The nodes, to look for what is near."""
        return cKDTree(self.xyz)


def gather_votes(field: PointField) -> Threads:
    """The threads of a field; empty where nothing is wood."""
    wood = np.flatnonzero(field.wood)
    of_voxel, field = np.full(len(field.xyz), -1), field.take(wood)
    weight = np.sqrt(field.count)
    voted = _mean_shift(field.xyz + field.offset, field.toward_foot, weight)
    density = _around(voted, field.toward_foot, LONELY_M) @ weight
    usual = float(np.median(density)) if len(density) else 0.0
    fewest = min(LEAST_VOTES, SPARSE * usual)
    kept = density >= max(fewest, min(LEAST_SHARE * usual, ENOUGH_VOTES))
    field, voted, weight, density = field.take(kept), voted[kept], weight[kept], density[kept]
    node = cover(voted, field.toward_foot, density, APART_M)
    of_voxel[wood[kept]] = node
    total = np.bincount(node, weight)

    def mean(values: Floats) -> Floats:
        sums = [np.bincount(node, weight * column) for column in values.T]
        return np.asarray(np.column_stack(sums) / total[:, None])

    xyz = mean(voted)
    role = np.exp(mean(np.log(np.maximum(field.role, LEAST_CHANCE))))
    toward_foot = unit(mean(field.toward_foot))
    along = ((field.xyz - xyz[node]) * toward_foot[node]).sum(axis=1)
    beyond = np.zeros((len(xyz), 2))
    np.maximum.at(beyond, node, np.column_stack([-along, along]))
    scatter = mean(((voted - xyz[node]) ** 2).sum(axis=1, keepdims=True))[:, 0]
    return Threads(
        xyz=xyz,
        role=role / role.sum(axis=1, keepdims=True),
        radius=mean(field.radius[:, None])[:, 0],
        toward_foot=toward_foot,
        votes=np.asarray(total, np.float64),
        scatter=np.sqrt(scatter),
        beyond=beyond,
        of_voxel=of_voxel,
    )


def _around(xyz: Floats, direction: Floats, reach: float) -> csr_array:
    """Which points (N, N) lie within `reach` of which and run the same way; each of itself too."""
    pairs = cKDTree(xyz).query_pairs(reach, output_type="ndarray")
    alike = (direction[pairs[:, 0]] * direction[pairs[:, 1]]).sum(axis=1) > ALIKE_COS
    pairs = pairs[alike]
    own = np.arange(len(xyz))
    rows = np.concatenate([pairs[:, 0], pairs[:, 1], own]).astype(np.int64)
    columns = np.concatenate([pairs[:, 1], pairs[:, 0], own]).astype(np.int64)
    return csr_array((np.ones(len(rows)), (rows, columns)), shape=(len(xyz), len(xyz)))


def _mean_shift(xyz: Floats, direction: Floats, weight: Floats) -> Floats:
    """One step: each point to the mean of those within the bandwidth."""
    near = _around(xyz, direction, SHIFT_M)
    return np.asarray((near @ (weight[:, None] * xyz)) / (near @ weight)[:, None])


def cover(xyz: Floats, direction: Floats, density: Floats, reach: float) -> Ints:
    """The node (V,) that each vote belongs to: a maximal independent set, the densest first.

    In each round every vote that is the densest of those still free within reach becomes a node,
    and takes those with it that run the same way (Luby's algorithm with density for chance).
    """
    near = _around(xyz, direction, reach)
    rank = np.empty(len(xyz))
    rank[np.lexsort((*xyz.T, density))] = np.arange(1, len(xyz) + 1)
    owner, free = np.zeros(len(xyz), np.int64), rank.copy()
    while free.any():
        densest = near.multiply(free[None, :]).tocsr().max(axis=1).toarray().ravel()
        chosen = (free > 0) & (densest == free)
        # A free vote belongs to the densest of the new nodes around it.
        best = near.multiply(np.where(chosen, free, 0.0)[None, :]).tocsr().max(axis=1)
        best = best.toarray().ravel()
        taken = (free > 0) & (best > 0)
        owner[taken] = best[taken]
        free[taken] = 0
    _, node = np.unique(owner, return_inverse=True)
    return np.asarray(node.ravel())
