"""From the views of a rig to one cloud (the paper's sec. Data collection, its first step).

Each view to points, flying pixels dropped; the branches that each sees to threads; the poses of all
views refined together; views that do not fit left out; what is left thinned to one cloud.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from prunus.errors import PrunusError
from prunus.model import Floats, Ints, RigidMotion, RigView
from prunus.model.arrays import Bytes
from prunus.sensing.register import MOVED, TURNED, Fit, fit_of, refined, turn_of
from prunus.sensing.threads import Threads, threads_of
from prunus.sensing.views import Seen, seen

VOXEL = 0.005
"""One point is kept in each cube of this side, metres."""
SAMPLES = 60
"""A view with fewer samples of branches cannot be placed."""
FAR = 4.0
"""A view moved or turned by more than so many standard deviations of the prior does not fit."""
AGREE = 0.6
"""Nor does one whose agreement is under this share of the median of the others'."""
APART = 2.0
"""Nor one whose distance is over so many times the median of the others'."""


@dataclass(frozen=True, eq=False)
class Placed:
    """What became of a view: its refined pose, and the evidence.

    `points`, `flying`: kept and dropped; `before`, `after`: median distance across branches to the
    other views, metres (NaN: none near); `agree`: share of its branches that others confirm;
    `moved` (metres), `turned` (degrees): from the nominal pose; `refused`: why, "" = it is in.
    """

    name: str
    pose: RigidMotion
    points: int
    flying: int
    before: float
    after: float
    agree: float
    moved: float
    turned: float
    refused: str


@dataclass(frozen=True, eq=False)
class Fused:
    """The fused cloud: xyz (P, 3) in the rig's frame, metres, rgb (P, 3) or None, every view."""

    xyz: Floats
    rgb: Bytes | None
    views: tuple[Placed, ...]


def fuse(views: list[RigView], seed: int = 0) -> Fused:
    """One cloud of all views that fit together; the seed decides which points stand for others.

    Raises PrunusError where no view holds a point, or no two of several views fit together.
    """
    rng = np.random.default_rng(seed)
    held = [seen(view) for view in views]
    if not any(len(one.xyz) for one in held):
        raise PrunusError("the views hold no points; expected some that see wood")
    threads = [threads_of(one, rng) for one in held]
    placed = place(held, threads)
    kept = [(one, own) for one, own in zip(placed, held, strict=True) if not one.refused]
    xyz = np.concatenate([one.pose.apply(own.xyz) for one, own in kept])
    coloured = all(own.rgb is not None for _, own in kept)
    rgb = np.concatenate([own.rgb for _, own in kept if own.rgb is not None]) if coloured else None
    rows = _one_each(xyz, rng)
    return Fused(xyz[rows], None if rgb is None else rgb[rows], tuple(placed))


def place(held: list[Seen], threads: list[Threads]) -> list[Placed]:
    """Refine the poses of all views that fit, leaving out the worst one by one."""
    nominal = [one.nominal for one in held]
    before = fit_of(threads, nominal)
    placed: dict[int, Placed] = {}
    inside = list(range(len(held)))
    while True:
        own = [threads[v] for v in inside]
        start = [nominal[v] for v in inside]
        poses = refined(own, start) if len(inside) > 1 else start
        fit = fit_of(own, poses)
        why = _misfits([len(one) for one in own], start, poses, fit)
        for k, v in enumerate(inside):
            placed[v] = _placed(held[v], poses[k], before.apart[v], fit, k, why[k][1])
        worst = max(range(len(inside)), key=lambda k: why[k][0])
        if not why[worst][1] or len(inside) == 1:
            break
        del inside[worst]
    if len(inside) == 1 < len(held):
        reasons = "; ".join(f"{one.name}: {one.refused}" for one in placed.values() if one.refused)
        raise PrunusError(f"no two of {len(held)} views fit together ({reasons}); expected two")
    return [placed[v] for v in range(len(held))]


def _misfits(
    samples: list[int], nominal: list[RigidMotion], poses: list[RigidMotion], fit: Fit
) -> list[tuple[float, str]]:
    """How far each view is beyond what is allowed (1 = just so), and in words ("" = it fits)."""
    found = []
    for k, pose in enumerate(poses):
        moved = float(np.linalg.norm(pose.translation - nominal[k].translation))
        turned = float(np.linalg.norm(turn_of(pose, nominal[k])))
        others = [o for o in range(len(poses)) if o != k]
        apart = float(np.nanmedian(fit.apart[others]))
        agree = float(np.median(fit.agree[others]))
        reasons = [
            (SAMPLES / max(samples[k], 1), f"only {samples[k]} samples of branches seen"),
            (moved / (FAR * MOVED), f"moved by {moved:.3f} m"),
            (turned / (FAR * TURNED), f"turned by {math.degrees(turned):.1f} degrees"),
            (AGREE * agree / max(fit.agree[k], 1e-3), f"{fit.agree[k]:.0%} of it is confirmed"),
            (fit.apart[k] / (APART * apart), f"{1000 * fit.apart[k]:.1f} mm from the others"),
        ]
        worst = max(reasons, key=lambda reason: np.nan_to_num(reason[0], nan=np.inf))
        found.append((worst[0], worst[1] if worst[0] > 1 else ""))
    return found


def _placed(
    own: Seen, pose: RigidMotion, before: float, fit: Fit, k: int, refused: str
) -> Placed:
    moved = float(np.linalg.norm(pose.translation - own.nominal.translation))
    turned = math.degrees(float(np.linalg.norm(turn_of(pose, own.nominal))))
    return Placed(
        own.name, pose, len(own.xyz), own.flying, float(before), float(fit.apart[k]),
        float(fit.agree[k]), moved, turned, refused,
    )  # fmt: skip


def _one_each(xyz: Floats, rng: np.random.Generator) -> Ints:
    """Rows of xyz (P, 3): one, drawn at random, in each cube of side `VOXEL`."""
    order = rng.permutation(len(xyz))
    cells = np.floor((xyz[order] - xyz.min(axis=0)) / VOXEL).astype(np.int64)
    ahead = (cells[:, 0] << 42) | (cells[:, 1] << 21) | cells[:, 2]
    return np.sort(order[np.unique(ahead, return_index=True)[1]])
