"""Threads as a graph of the kind that the rest of the house looks at: nodes, edges, confidence."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from prunus.field.votes import Threads
from prunus.growth.graph import confidence_of
from prunus.growth.grow import Orchard
from prunus.model import (
    CandidateGraph,
    Floats,
    Ints,
    PointCloud,
    Role,
    ScoredGraph,
    SeededGraph,
    Skeleton,
    Superpoints,
)

REACH_M = 0.03
"""A node stands for the points so near to the surface of its branch."""


def seeded_graph(
    cloud: PointCloud, of_voxel: Ints, voxels: Floats, orchard: Orchard, tree: Skeleton
) -> SeededGraph:
    """The graph of the trees in view, and the tree that is meant: its edges, its base, its tips.

    cloud: the points of that tree; of_voxel (P,): the voxel that holds each; voxels (V, 3): where
    these are. Edges of the tree are as sure as they are in it.
    """
    graph = orchard.graph
    threads = graph.threads
    own = np.sort(tree.superpoint[tree.edges], axis=1)
    edges, row = np.unique(np.concatenate([graph.edges, own]), axis=0, return_inverse=True)
    confidence = np.maximum(confidence_of(threads, edges), confidence_of(threads, edges[:, ::-1]))
    confidence[row[len(graph.edges) :]] = tree.confidence[1:]
    role = np.sqrt(threads.role[edges[:, 0]] * threads.role[edges[:, 1]])
    superpoints = _superpoints(cloud, of_voxel, voxels, graph.threads)
    scored = ScoredGraph(
        candidates=CandidateGraph(superpoints, edges),
        confidence=confidence,
        category=_categories(role),
        scorer="field",
    )
    return SeededGraph(scored, orchard.main, np.sort(tree.superpoint[_tips(tree)]))


def _superpoints(
    cloud: PointCloud, of_voxel: Ints, voxels: Floats, threads: Threads
) -> Superpoints:
    """The nodes with the points of the voxels within their reach."""
    near = cKDTree(voxels).query_ball_point(threads.xyz, threads.radius + REACH_M)
    order = np.argsort(of_voxel, kind="stable")
    first = np.searchsorted(of_voxel[order], np.arange(len(voxels) + 1))
    held = [np.concatenate([order[first[v] : first[v + 1]] for v in some]) if some else order[:0]
            for some in near]  # fmt: skip
    start = np.cumsum([0, *map(len, held)])
    return Superpoints(cloud, threads.xyz, start, np.concatenate(held), REACH_M)


def _categories(role: Floats) -> Floats:
    """Trunk, support, leader, side branch and other wood (E, 5)."""
    other = role[:, Role.SPUR_OR_SHOOT] + role[:, Role.NO_WOOD]
    told = np.column_stack([role[:, : Role.SPUR_OR_SHOOT], other])
    return np.asarray(told / np.maximum(told.sum(axis=1, keepdims=True), 1e-9))


def _tips(tree: Skeleton) -> Ints:
    """The rows of a tree from which nothing grows on."""
    return np.setdiff1d(np.arange(1, len(tree)), tree.parent)
