"""The trees of the experiment: their points as a person would leave them, and their truth."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, Protocol

import numpy as np
from scipy.spatial import cKDTree

from prunus.field.network import see_field
from prunus.field.votes import LEAST_WOOD, PointField
from prunus.field.voxels import Voxels
from prunus.lab.evaluate.seen import counting_rows
from prunus.lab.experiment.habits import habits_of
from prunus.lab.learn.edges.labels import TrueWood, edge_labels
from prunus.lab.simulate.scan import Scan, simulate_scan
from prunus.lab.simulate.settings import Setting
from prunus.model import Bools, CandidateGraph, Floats, Label, PointCloud, Role, Skeleton
from prunus.model.branches import branch_of_rows, branches


@dataclass(frozen=True, eq=False, kw_only=True)
class Tree:
    """The cloud of one tree alone, as a person leaves it who removes all else by hand.

    truth: its skeleton, in the frame of the cloud's file, and which of its rows (M,) count;
    `habits` names what is difficult about it.
    """

    name: str
    cloud: PointCloud
    truth: Skeleton
    counts: Bools
    habits: tuple[str, ...]


class Subject(Protocol):
    """A tree that can be tried: where it comes from, before it is looked at."""

    @property
    def name(self) -> str:
        """What the tree is called."""

    @property
    def made_of(self) -> str:
        """What the tree depends on, as text: another text, another tree."""

    def tree(self) -> Tree:
        """The tree. PrunusError where it cannot be had."""

    def by_hand(self) -> list[dict[str, Any]]:
        """Trials that people corrected."""

    def edges(self) -> dict[str, Any]:
        """What the edge network says of its edges (`experiment.edges`); empty: nothing known."""


@dataclass(frozen=True)
class Simulated:
    """A simulated tree: a program that knows it makes the corrections."""

    seed: int
    setting: Setting

    @property
    def name(self) -> str:
        """The name that `prunus simulate` would give it."""
        return f"tree_{self.seed}"

    @property
    def made_of(self) -> str:
        """The setting; the seed is in the name."""
        return self.setting

    def tree(self) -> Tree:
        """The target of the scan of that seed."""
        return tree_of(self.seed, self.setting)

    def by_hand(self) -> list[dict[str, Any]]:
        """None: nobody corrected it."""
        return []

    def edges(self) -> dict[str, Any]:
        """The network on all candidate edges."""
        from prunus.lab.experiment.edges import edge_record

        return edge_record(self.tree())


@lru_cache(maxsize=4)
def tree_of(seed: int, setting: Setting = "hard") -> Tree:
    """The target of the scan of that seed."""
    return target_of(simulate_scan(seed, setting), f"tree_{seed}")


def target_of(scan: Scan, name: str) -> Tree:
    """The target of a scan."""
    truth = scan.truth
    row = np.where(scan.truth_rows, np.cumsum(scan.truth_rows) - 1, -1)
    own = scan.tree == 0
    at = row[scan.node[own]]
    branch = np.where(at >= 0, branch_of_rows(branches(truth), len(truth))[at], -1)
    counts = counting_rows(truth, scan.xyz[own], branch)
    cloud = PointCloud.from_xyz(scan.xyz[own])
    return Tree(name=name, cloud=cloud, truth=truth, counts=counts, habits=habits_of(truth))


@dataclass(frozen=True)
class OracleScorer:
    """Who knows the tree: every candidate edge gets its true validity and category."""

    tree: Tree
    name: str = "oracle"

    def __call__(self, candidates: CandidateGraph) -> Floats:
        """Confidence (E,): 1 where the edge follows wood."""
        return self.judge(candidates)[0]

    def judge(self, candidates: CandidateGraph) -> tuple[Floats, Floats]:
        """Confidence (E,) and category (E, 5), both 0 or 1; of edges that follow none, any."""
        nodes = candidates.superpoints.cloud.to_input.apply(candidates.xyz)
        found = edge_labels(nodes, candidates.edges, TrueWood.of([self.tree.truth]))
        category = np.eye(len(Label) + 1)[np.maximum(found, 0)]
        category[found < 0] = 1 / (len(Label) + 1)
        return (found >= 0).astype(np.float64), category


ON_WOOD_M = 0.05
"""A voxel whose vote lies so near to true wood is of that wood."""
SURE = 0.95
"""How likely the true class of a voxel is said to be."""


@dataclass(frozen=True)
class TrueClasses:
    """The point field of one who knows the tree: the true class of every voxel.

    Of what is none of the true tree that is a spur which the network sees as wood, and the rest is
    no wood. Places, radii and directions are the network's.
    """

    tree: Tree

    def __call__(self, voxels: Voxels) -> PointField:
        """The field of voxels of the tree's cloud."""
        field = see_field(voxels)
        truth = self.tree.truth.moved(self.tree.cloud.to_input.inverse())
        away, row = cKDTree(truth.xyz).query(field.xyz + field.offset)
        wood = 1 - field.role[:, Role.NO_WOOD] >= LEAST_WOOD
        other = np.where(wood, int(Role.SPUR_OR_SHOOT), int(Role.NO_WOOD))
        role = np.where(away <= ON_WOOD_M, truth.label[np.minimum(row, len(truth) - 1)], other)
        told = np.full(field.role.shape, (1 - SURE) / (len(Role) - 1))
        told[np.arange(len(role)), role] = SURE
        return replace(field, role=told)
