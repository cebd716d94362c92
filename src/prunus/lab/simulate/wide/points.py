"""The truth of every point of a simulated scan: role, branch, axis, radius, direction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from prunus.geometry.vectors import unit
from prunus.lab.simulate.row import NONE
from prunus.lab.simulate.scan import Scan
from prunus.lab.simulate.scan_folder import ScannedTree
from prunus.model import Floats, Ints, Label, Role, Skeleton
from prunus.model.branches import branch_of_rows, branches

UNKNOWN_ROLE = -1  # wood of a tree of which no role is known
UNTOLD = -2  # nobody knows whether it is wood, as of what a person did not draw in a real scan
SPUR_M = 0.06  # shorter branches are spurs

ROLE_OF_LABEL = np.array([Role.STEM, Role.FRAMEWORK, Role.FRUITING_UNIT, Role.LATERAL])


@dataclass(frozen=True, eq=False, kw_only=True)
class PointTruth:
    """What is true of each of P points.

    role (P,), `UNKNOWN_ROLE` where only its being wood is known, `UNTOLD` where not even that;
    branch (P,), counted over all trees, -1 = none, -2 = untold; axis (P, 3), the nearest point of
    the axis of its branch; radius (P,) there, metres, NaN where it is not known; toward_foot
    (P, 3), the unit direction of that axis. Where there is no wood the axis is the point itself,
    and the others are zero.
    """

    role: Ints
    branch: Ints
    axis: Floats
    radius: Floats
    toward_foot: Floats


def point_truth(scan: Scan) -> PointTruth:
    """The truth of the points of a scan, wood of neighbours included."""
    return _truth(scan.xyz, scan.tree, scan.node, scan.row.trees)


def written_truth(scan: ScannedTree) -> PointTruth:
    """The same of a scan that was written and read back.

    The files tell the branch of a point, not the edge that it was drawn from. The nearest edge of
    the branch stands for it: one or two away, 2 cm each, where noise moved the point along.
    """
    node = np.full(len(scan.xyz), NONE)
    for number, tree in enumerate(scan.trees):
        own = np.flatnonzero(scan.tree == number)
        node[own] = _nearest_rows(tree, scan.branch[own], scan.xyz[own])
    return _truth(scan.xyz, scan.tree, node, scan.trees)


def _nearest_rows(tree: Skeleton, branch: Ints, xyz: Floats) -> Ints:
    """The row of each point (P, 3): the edge of its branch whose middle is the nearest."""
    row = np.zeros(len(xyz), np.int64)
    middle = (tree.xyz + tree.xyz[np.maximum(tree.parent, 0)]) / 2
    for number, one in enumerate(branches(tree)):
        own = np.flatnonzero(branch == number)
        if len(own):
            rows = one.rows[1:]
            row[own] = rows[cKDTree(middle[rows]).query(xyz[own])[1]]
    return row


def _truth(xyz: Floats, whose: Ints, node: Ints, trees: list[Skeleton]) -> PointTruth:
    """Of points (P, 3) of trees (P,) and rows of these (P,), -1 = no wood."""
    count = len(xyz)
    role, branch = np.full(count, int(Role.NO_WOOD)), np.full(count, -1)
    axis, radius, direction = xyz.copy(), np.zeros(count), np.zeros((count, 3))
    numbered = 0
    for number, tree in enumerate(trees):
        own = np.flatnonzero(whose == number)
        row = node[own]
        roles, owner = roles_of(tree)
        role[own], branch[own] = roles[row], owner[row] + numbered
        axis[own] = on_axis(tree, row, xyz[own])
        radius[own] = tree.radius[row]
        direction[own] = -unit(tree.edge_vectors[row])
        numbered += owner.max(initial=-1) + 1
    return PointTruth(role=role, branch=branch, axis=axis, radius=radius, toward_foot=direction)


def roles_of(tree: Skeleton) -> tuple[Ints, Ints]:
    """The role (M,) and the branch (M,) of the edge that ends in each row.

    Side branches shorter than 6 cm, and those on trunk and supports, are spurs or shoots. Of trees
    without leaders the stem alone, and the spurs, have a role.
    """
    found = branches(tree)
    owner = branch_of_rows(found, len(tree))
    role = ROLE_OF_LABEL[tree.label].astype(np.int64)
    ufo = bool((tree.label == Label.LEADER).any())
    for number, one in enumerate(found):
        if one.label != Label.SIDE_BRANCH:
            continue
        carrier = tree.label[one.rows[0]] if one.rows[0] > 0 else Label.TRUNK
        shoot = ufo and carrier in (Label.TRUNK, Label.SUPPORT)
        if shoot or one.length < SPUR_M:
            role[owner == number] = Role.SPUR_OR_SHOOT
        elif not ufo:
            role[owner == number] = UNKNOWN_ROLE
    return role, owner


def on_axis(tree: Skeleton, row: Ints, xyz: Floats) -> Floats:
    """The nearest points (P, 3) on the edges that end in rows (P,), and on those next to them.

    Noise moves a point along its branch too, past the end of the edge that it was drawn from; so
    the edge below and one above are looked at as well.
    """
    above = np.arange(len(tree))
    above[tree.parent[1:][::-1]] = np.arange(1, len(tree))[::-1]
    same = tree.label[above] == tree.label
    best, nearest = np.full(len(xyz), np.inf), np.zeros_like(xyz)
    for edge in (row, np.maximum(tree.parent[row], 1), np.where(same[row], above[row], row)):
        start, end = tree.xyz[tree.parent[edge]], tree.xyz[edge]
        vector = end - start
        share = ((xyz - start) * vector).sum(axis=1) / np.maximum((vector**2).sum(axis=1), 1e-12)
        place = start + np.clip(share, 0, 1)[:, None] * vector
        distance = ((xyz - place) ** 2).sum(axis=1)
        closer = distance < best
        nearest[closer], best[closer] = place[closer], distance[closer]
    return nearest
