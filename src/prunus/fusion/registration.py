"""Refine the poses of all views at once, so that the branches that they see fall on each other.

Unknown are V motions of six numbers. Each sample of a branch axis (see `sensing.threads`) looks for
the nearest one of like direction in every other view, nearer and nearer by; what it lies beside
that one's line is to vanish, weighted by how well it is known and robustly. The nominal poses are
the prior, which also holds what the views cannot tell: where all of them stand together.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from prunus.fusion.axis_samples import Threads
from prunus.fusion.normal_equations import normal_equations, partners, residuals
from prunus.model import Floats, Ints, RigidMotion
from prunus.model.rotations import cross, turn_of, turned

TURNED = math.radians(1.0)
"""Prior of the nominal poses: standard deviation of each turn, radians."""
MOVED = 0.012
"""The same of each shift, metres."""
ALIKE_ERR = 0.1
"""Share of the samples' weight that counts: neighbours on a branch err alike."""
STILL = 2e-6
"""Steps under this (radians, metres) end a stage."""


@dataclass(frozen=True, kw_only=True)
class Stage:
    """Partners within `reach` metres, axes alike in their cosine, and how robust (deviations)."""

    reach: float
    alike: float
    scale: float
    steps: int


STAGES = (
    Stage(reach=0.08, alike=0.80, scale=4.0, steps=8),
    Stage(reach=0.04, alike=0.90, scale=3.0, steps=6),
    Stage(reach=0.02, alike=0.94, scale=2.5, steps=12),
)
"""From coarse to fine."""
WIDE, CLOSE = STAGES[0], STAGES[-1]


@dataclass(frozen=True, eq=False)
class Fit:
    """How well the views fit: median distance across branches (V,), metres, and agreement (V,).

    The distance is from each sample to the nearest in any other view within 8 cm (NaN: none is so
    near); the agreement is the share of these samples that have one of like direction within 2 cm.
    """

    apart: Floats
    agree: Floats


def refined(threads: list[Threads], nominal: list[RigidMotion]) -> list[RigidMotion]:
    """The poses of the views that fit best together near the nominal ones."""
    poses = list(nominal)
    seen = [pose.apply(own.xyz) for pose, own in zip(poses, threads, strict=True)]
    middle = np.median(np.concatenate(seen), axis=0) if sum(map(len, seen)) else np.zeros(3)
    for stage in STAGES:
        for _ in range(stage.steps):
            step = _step(threads, poses, nominal, middle, stage)
            poses = [_moved(p, one, middle) for p, one in zip(poses, step, strict=True)]
            if np.abs(step).max() < STILL:
                break
    return poses


def fit_of(threads: list[Threads], poses: list[RigidMotion]) -> Fit:
    """How well views in these poses fit."""
    xyz, axis, doubt, view = _together(threads, poses, np.zeros(3))
    wide = partners(xyz, axis, view, len(threads), WIDE.reach, WIDE.alike)
    metres, _ = residuals(xyz, axis, doubt, wide)
    close = partners(xyz, axis, view, len(threads), CLOSE.reach, CLOSE.alike)
    nearest = np.where(np.isnan(metres), np.inf, metres).min(axis=1)
    met = (close >= 0).max(axis=1)
    apart, agree = np.full(len(threads), np.nan), np.zeros(len(threads))
    for v in np.unique(view):
        near = nearest[(view == v) & np.isfinite(nearest)]
        apart[v] = np.median(near) if len(near) else np.nan
        agree[v] = np.count_nonzero(met & (view == v)) / max(len(near), 1)
    return Fit(apart, agree)


def _together(
    threads: list[Threads], poses: list[RigidMotion], middle: Floats
) -> tuple[Floats, Floats, Floats, Ints]:
    """All samples in the rig's frame about a middle: xyz, axis, doubt, and whose view (S,)."""
    both = list(zip(poses, threads, strict=True))
    xyz = np.concatenate([pose.apply(own.xyz) for pose, own in both]) - middle
    axis = np.concatenate([own.axis @ pose.rotation.T for pose, own in both])
    doubt = [pose.rotation @ own.doubt @ pose.rotation.T for pose, own in both]
    view = np.repeat(np.arange(len(threads)), [len(own) for own in threads])
    return xyz, axis, np.concatenate(doubt), view


def _step(
    threads: list[Threads],
    poses: list[RigidMotion],
    nominal: list[RigidMotion],
    middle: Floats,
    stage: Stage,
) -> Floats:
    """The Gauss-Newton step of each view (V, 6): a turn about the middle, then a shift."""
    xyz, axis, doubt, view = _together(threads, poses, middle)
    mates = partners(xyz, axis, view, len(poses), stage.reach, stage.alike)
    matrix, right = normal_equations(xyz, axis, doubt, view, mates, stage.scale)
    matrix, right = ALIKE_ERR * matrix, ALIKE_ERR * right
    weight = np.repeat([TURNED**-2.0, MOVED**-2.0], 3)
    for v, (pose, before) in enumerate(zip(poses, nominal, strict=True)):
        own, held = slice(6 * v, 6 * v + 6), threads[v].held
        jacobian = np.eye(6)
        jacobian[3:, :3] = -cross(pose.apply(held) - middle)
        off = np.concatenate([turn_of(pose, before), pose.apply(held) - before.apply(held)])
        matrix[own, own] += jacobian.T @ (weight[:, None] * jacobian)
        right[own] -= jacobian.T @ (weight * off)
    return np.linalg.solve(matrix, right).reshape(-1, 6)


def _moved(pose: RigidMotion, step: Floats, middle: Floats) -> RigidMotion:
    """A pose after a step."""
    turn = turned(step[:3])
    rotation, _ = np.linalg.qr(turn @ pose.rotation)
    rotation *= np.sign((rotation * (turn @ pose.rotation)).sum(axis=0))
    return RigidMotion(rotation, turn @ (pose.translation - middle) + middle + step[3:])
