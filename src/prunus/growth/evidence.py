"""Threads as a graph of the kind that the rest of the house looks at: nodes, edges, confidence."""

from __future__ import annotations

import numpy as np

from prunus.field.voxels import Voxels
from prunus.growth.graph import ThreadGraph
from prunus.model import (
    CandidateGraph,
    Floats,
    Ints,
    PointCloud,
    Role,
    ScoredGraph,
    SeededGraph,
    Superpoints,
)

REACH_M = 0.03
"""A node stands for wood so far along its branch, both ways."""


def seeded_graph(cloud: PointCloud, voxels: Voxels, graph: ThreadGraph, foot: int) -> SeededGraph:
    """The graph of the threads of a cloud whose voxels these are; its base is the foot."""
    threads = graph.threads
    edges, first = np.unique(graph.edges, axis=0, return_index=True)
    role = np.sqrt(threads.role[edges[:, 0]] * threads.role[edges[:, 1]])
    wood = 1 - role[:, Role.NO_WOOD]
    length = np.linalg.norm(threads.xyz[edges[:, 0]] - threads.xyz[edges[:, 1]], axis=1)
    cost = np.minimum(*graph.costs.reshape(2, -1))[first]
    confidence = wood * np.clip(length / np.maximum(cost, 1e-9), 0.0, 1.0)
    return SeededGraph(
        ScoredGraph(
            CandidateGraph(_superpoints(cloud, voxels, graph), edges), confidence,
            _categories(role), "field",
        ),
        foot, _tips(graph),
    )  # fmt: skip


def _superpoints(cloud: PointCloud, voxels: Voxels, graph: ThreadGraph) -> Superpoints:
    threads = graph.threads
    node = threads.of_voxel[voxels.of_point]
    order = np.argsort(node, kind="stable")
    order = order[np.searchsorted(node[order], 0) :]
    start = np.searchsorted(node[order], np.arange(len(threads) + 1))
    return Superpoints(
        cloud, threads.xyz, start, order, REACH_M, np.full(len(threads), REACH_M / 2)
    )


def _categories(role: Floats) -> Floats:
    """Trunk, support, leader, side branch and other wood (E, 5)."""
    other = role[:, Role.SPUR_OR_SHOOT] + role[:, Role.NO_WOOD]
    told = np.column_stack([role[:, : Role.SPUR_OR_SHOOT], other])
    return np.asarray(told / np.maximum(told.sum(axis=1, keepdims=True), 1e-9))


def _tips(graph: ThreadGraph) -> Ints:
    """The nodes from which no way goes on outward: those that hang on one other alone."""
    count = np.bincount(graph.edges[~graph.gap].ravel(), minlength=len(graph.threads))
    return np.flatnonzero(count == 1)
