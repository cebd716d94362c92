"""The scan of an orchard row, as the paper's rig records it (sec. Data collection).

Two stereo cameras, one above the other, the upper tilted down, at three stops of a slide: six
depth images with poses, registered a few millimetres and tenths of a degree wrong, back-projected
to one cloud. Every point knows what it belongs to.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from prunus.lab.simulate.depth import GROUND, NOTHING, draw_ground, draw_wood, points_of
from prunus.lab.simulate.row import NONE, Pieces, Row, plant_row
from prunus.lab.simulate.settings import (
    RigSettings,
    ScanSettings,
    Setting,
    habits_in,
    scan_settings,
)
from prunus.lab.simulate.stereo import focal_length, hold_of, matched
from prunus.model import Bools, Floats, Ints, Kind, Label, PointCloud, RigidMotion, Skeleton
from prunus.model.arrays import cubes

CELL = 0.04
"""Side of the cells of uneven ground, metres."""


@dataclass(frozen=True, eq=False)
class View:
    """A depth image (H, W), metres, 0 = nothing, and the pose of its camera in the house frame.

    `nominal` is the pose that the rig believes in; `pose` the true one.
    """

    depth: Floats
    pose: RigidMotion
    nominal: RigidMotion


@dataclass(frozen=True, eq=False, kw_only=True)
class Scan:
    """A cloud with the truth of every point: kind (P,), tree (P,) and row of that tree (P,).

    `tree` and `node` are -1 for what is no wood. The house frame has its origin where the
    target's trunk meets the ground.
    """

    xyz: Floats
    kind: Ints
    tree: Ints
    node: Ints
    row: Row
    views: tuple[View, ...]
    focal: float

    @property
    def truth(self) -> Skeleton:
        """The target's true skeleton, from the lowest point of its trunk that the scan holds."""
        return self.row.trees[0].part(self.truth_rows)

    @property
    def truth_rows(self) -> Bools:
        """Which rows (M,) of the target tree stand in `truth`."""
        tree = self.row.trees[0]
        seen = np.unique(self.node[self.tree == 0])
        trunk = np.flatnonzero(tree.label == Label.TRUNK)
        held = np.intersect1d(trunk, seen)
        return above(tree, int(held[0] if len(held) else trunk[-1]))

    def cloud(self, kinds: tuple[Kind, ...] = tuple(Kind)) -> PointCloud:
        """The points of these kinds."""
        return PointCloud.from_xyz(self.xyz[np.isin(self.kind, kinds)])

    def target_cloud(self) -> PointCloud:
        """The points of the target alone: what a person leaves who removes all else by hand."""
        return self.cloud((Kind.TARGET,))


def simulate_scan(seed: int, setting: Setting = "hard") -> Scan:
    """The scan of that seed: the same seed and setting give the same scan."""
    rng = np.random.default_rng([seed, 0])
    settings = scan_settings(setting)
    row = plant_row(rng, settings.row, habits_in(setting))
    return scan_row(row, rng, settings)


def scan_row(row: Row, rng: np.random.Generator, settings: ScanSettings) -> Scan:
    """Six views of a row, back-projected to one cloud."""
    focal = focal_length(settings.rig)
    hold = hold_of(rng, row.pieces, settings.stereo)
    ground = rng.normal(0, settings.row.ground_rough, (100, 100))
    far = rng.uniform(*settings.rig.far)
    edge = -rng.uniform(*settings.row.bare), rng.uniform(*settings.row.buried)
    views, clouds, owners = [], [], []
    for pose in _poses(rng, settings.rig):
        depth, owner = _true_depth(row.pieces, pose, ground, settings.rig)
        depth, owner = matched(rng, depth, owner, hold, settings.stereo, settings.rig)
        depth = np.where((depth > settings.rig.near) & (depth < far), depth, 0.0)
        points, rows, columns = points_of(depth, focal)
        points, whose = pose.apply(points), owner[rows, columns]
        hidden = _hidden(points, whose, edge)
        depth[rows[hidden], columns[hidden]] = 0.0
        nominal = _misplaced(rng, pose, settings.rig)
        views.append(View(depth, pose, nominal))
        seen = pose.inverse().apply(points[~hidden])
        clouds.append(nominal.apply(seen))
        owners.append(whose[~hidden])
    return _labelled(np.concatenate(clouds), np.concatenate(owners), row, tuple(views), focal,
                     rng=rng, settings=settings)  # fmt: skip


def above(tree: Skeleton, row: int) -> Bools:
    """Which rows (M,) of a tree hang on a row, that one included."""
    kept = np.zeros(len(tree), np.bool_)
    kept[row] = True
    for child in range(row + 1, len(tree)):
        kept[child] = kept[tree.parent[child]]
    return kept


def _poses(rng: np.random.Generator, rig: RigSettings) -> list[RigidMotion]:
    """True poses of the cameras: three stops, the lower and the upper at each."""
    low = rng.uniform(*rig.low)
    heights = (low, low + rng.uniform(*rig.between))
    tilts = (0.0, math.radians(rng.uniform(*rig.tilt)))
    middle, stop, distance = (rng.uniform(*x) for x in (rig.aim, rig.stops, rig.distance))
    poses = []
    for k in (-1, 0, 1):
        for height, tilt in zip(heights, tilts, strict=True):
            c, s = math.cos(tilt), math.sin(tilt)
            axes = np.array([[1.0, 0.0, 0.0], [0.0, -s, c], [0.0, -c, -s]])
            poses.append(RigidMotion(axes, np.array([middle + k * stop, -distance, height])))
    return poses


def _misplaced(rng: np.random.Generator, pose: RigidMotion, rig: RigSettings) -> RigidMotion:
    """The pose as registration believes it: turned and moved a little."""
    turn = np.radians(rng.normal(0, rig.turned, 3))
    cross = np.array([[0, -turn[2], turn[1]], [turn[2], 0, -turn[0]], [-turn[1], turn[0], 0]])
    rotation, _ = np.linalg.qr(np.eye(3) + cross)
    rotation *= np.sign(np.diag(rotation))
    moved = rng.normal(0, rig.moved, 3)
    return RigidMotion(pose.rotation @ rotation, pose.translation + moved)


def _true_depth(
    pieces: Pieces, pose: RigidMotion, ground: Floats, rig: RigSettings
) -> tuple[Floats, Ints]:
    """Depth and owner (H, W) without faults."""
    focal = focal_length(rig)
    depth = np.zeros((rig.height, rig.width))
    owner = np.full(depth.shape, NOTHING)
    back = pose.inverse()
    draw_wood(back.apply(pieces.start), back.apply(pieces.end), pieces.radius, focal, depth, owner)
    draw_ground(pose.rotation, pose.translation, focal, ground, CELL, depth, owner)
    return depth, owner


def _hidden(points: Floats, owner: Ints, edge: tuple[float, float]) -> Bools:
    """Points that a field scan lacks: ground under the trees, and wood close to it."""
    bare, buried = edge
    soil = (owner == GROUND) & (points[:, 1] > bare)
    return np.asarray(soil | ((owner >= 0) & (points[:, 2] < buried) & (points[:, 1] > bare)))


def _labelled(
    xyz: Floats,
    owner: Ints,
    row: Row,
    views: tuple[View, ...],
    focal: float,
    *,
    rng: np.random.Generator,
    settings: ScanSettings,
) -> Scan:
    """The scan with strays among its points, and the truth of each looked up."""
    strays = round(settings.stereo.stray * len(xyz))
    xyz = np.concatenate([xyz, rng.uniform(xyz.min(axis=0), xyz.max(axis=0), (strays, 3))])
    owner = np.concatenate([owner, np.full(strays, NOTHING)])
    kept = _thinned(rng, xyz, settings.stereo.voxel)
    xyz, owner = xyz[kept], owner[kept]
    piece = np.maximum(owner, 0)
    kind = np.where(owner >= 0, row.pieces.kind[piece], Kind.STRAY)
    kind[owner == GROUND] = Kind.GROUND
    tree = np.where(owner >= 0, row.pieces.tree[piece], NONE)
    node = np.where(owner >= 0, row.pieces.row[piece], NONE)
    return Scan(xyz=xyz, kind=kind, tree=tree, node=node, row=row, views=views, focal=focal)


def _thinned(rng: np.random.Generator, xyz: Floats, voxel: float) -> Ints:
    """One point of each cube, drawn at random: rows of `xyz` (P, 3)."""
    order = rng.permutation(len(xyz))
    _, first = np.unique(cubes(xyz[order], voxel), return_index=True)
    return np.asarray(order[first])
