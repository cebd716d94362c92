"""What the point field tells of a grown tree: the evidence for how far to trust it."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from prunus.field.votes import PointField
from prunus.growth.feet import standing
from prunus.growth.grow import Orchard
from prunus.model import Bools, Floats, Skeleton, Told

REACH_M = 0.03
"""A skeleton explains votes so near to it."""
AROUND_M = 0.08
"""What is no wood and lies so near to a skeleton is around it."""
SURE = 4.0
"""No lead over another tree is larger, log odds."""
TINY = 1e-9


def told_of(
    tree: Skeleton, orchard: Orchard, field: PointField, scan: PointField, lead: float
) -> Told:
    """What the field from which an orchard grew tells of its tree that is meant.

    scan: the field of all that was scanned, where the tree was isolated of more; lead: see
    `lead_of`.
    """
    threads = orchard.graph.threads
    nodes = tree.superpoint
    return Told(
        role=threads.role[nodes], scatter=threads.scatter[nodes],
        whole=_whole(tree, orchard, field) | {"around": _around(tree, scan), "lead": lead},
    )  # fmt: skip


def _whole(tree: Skeleton, orchard: Orchard, field: PointField) -> dict[str, float]:
    """What is told of it by number.

    Of the voxels of the tree: `unclear`, the entropy of their roles in the mean; `explained`, the
    share whose votes lie near its skeleton. Of all wood in view: `loose`, the share of no tree.
    `astray`: how far the skeleton runs off the directions of the field, 0 to 2.
    """
    foot = orchard.foot_of_voxel()
    own = foot == orchard.main
    role, votes = field.role[own], (field.xyz + field.offset)[own]
    near = cKDTree(tree.xyz).query(votes, distance_upper_bound=REACH_M)[0] < REACH_M
    return {
        "unclear": float(-(role * np.log(role + TINY)).sum() / max(len(role), 1)),
        "explained": _share(near),
        "loose": _share(foot[field.wood] < 0),
        "astray": _astray(tree, orchard.graph.threads.toward_foot[tree.superpoint]),
    }


def _around(tree: Skeleton, scan: PointField) -> float:
    """The share of the voxels around a skeleton that are no wood."""
    away = cKDTree(tree.xyz).query(scan.xyz, distance_upper_bound=AROUND_M)[0]
    return _share(~scan.wood[away < AROUND_M])


def _astray(tree: Skeleton, toward_foot: Floats) -> float:
    """How far its edges are off the directions (M, 3) said there, in the mean over its length."""
    way = tree.xyz[1:] - tree.xyz[tree.parent[1:]]
    length = np.linalg.norm(way, axis=1)
    return float((length + (way * toward_foot[1:]).sum(axis=1)).sum() / max(length.sum(), TINY))


def lead_of(orchard: Orchard) -> float:
    """By how much more speaks, log odds, for its tree as the one meant than for any other."""
    if len(orchard.feet) == 1:
        return SURE
    chance = standing(orchard.graph.threads, orchard.ways.foot, orchard.feet)
    own = orchard.feet == orchard.main
    return float(np.clip(chance[own][0] - chance[~own].max(), -SURE, SURE))


def _share(some: Bools) -> float:
    return float(some.mean()) if len(some) else 0.0
