"""From the views of a rig to one cloud (the paper's sec. Data collection, its first step).

Each view to points, flying pixels dropped; the branches that each sees to threads; the poses of all
views refined together; views that do not fit left out; what is left thinned to one cloud.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from prunus.errors import PrunusError
from prunus.fusion.axis_samples import Threads, threads_of
from prunus.fusion.registration import MOVED, TURNED, Fit, fit_of, refined
from prunus.fusion.views import Seen, seen
from prunus.model import Floats, Ints, RigidMotion, RigView
from prunus.model.arrays import Bytes, cubes
from prunus.model.rotations import turn_of

VOXEL_M = 0.005
"""One point is kept in each cube of this side."""
MIN_SAMPLES = 60
"""A view with fewer samples of branches cannot be placed."""
MAX_MOVE = 4.0
"""A view that moved or turned by more standard deviations of the prior is refused."""
MIN_AGREEMENT_SHARE = 0.65
"""A view whose agreement is less, over the median of the others, is refused."""
MIN_AGREEMENT = 0.2
"""A view whose agreement is less is refused."""
MAX_DISTANCE_SHARE = 1.8
"""A view whose distance is more, over the median of the others, is refused."""
TINY = 1e-3

_Fault = tuple[float, str]


@dataclass(frozen=True, eq=False, kw_only=True)
class Placed:
    """What became of a view: its refined pose, and the evidence.

    `points`, `flying`: kept and dropped; `before`, `after`: median distance across branches to the
    other views, metres (NaN: none near); `agree`: the share of its samples that
    others confirm (see `Fit`); `moved` (metres), `turned` (degrees): from the nominal pose;
    `refused`: why, "" = it is in.
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
    kept = [k for k, view in enumerate(placed) if not view.refused]
    xyz, rgb = merged([held[k] for k in kept], [placed[k].pose for k in kept], rng)
    return Fused(xyz, rgb, tuple(placed))


def merged(
    held: list[Seen], poses: list[RigidMotion], rng: np.random.Generator
) -> tuple[Floats, Bytes | None]:
    """The points of all views in these poses, one in each cube of `VOXEL_M`, and their colours.

    Colours are kept where every view has them.
    """
    xyz = np.concatenate([pose.apply(own.xyz) for pose, own in zip(poses, held, strict=True)])
    rows = _one_each(xyz, rng)
    colours = [own.rgb for own in held if own.rgb is not None]
    return xyz[rows], np.concatenate(colours)[rows] if len(colours) == len(held) else None


def place(held: list[Seen], threads: list[Threads]) -> list[Placed]:
    """Refine the poses of all views that fit, leaving out the worst one by one."""
    before = fit_of(threads, [one.nominal for one in held])
    placed: dict[int, Placed] = {}
    inside = list(range(len(held)))
    while True:
        tried, faults = _try(inside, held, threads, before)
        placed |= tried
        worst = int(np.argmax(faults))
        if faults[worst] == 0:
            break
        del inside[worst]
    if len(inside) == 1 < len(held):
        reasons = "; ".join(f"{one.name}: {one.refused}" for one in placed.values() if one.refused)
        raise PrunusError(f"no two of {len(held)} views fit together ({reasons}); expected two")
    return [placed[v] for v in range(len(held))]


def _try(
    inside: list[int], held: list[Seen], threads: list[Threads], before: Fit
) -> tuple[dict[int, Placed], list[float]]:
    """The views inside with their poses refined together, and how great the fault of each is."""
    own, nominal = [threads[v] for v in inside], [held[v].nominal for v in inside]
    poses = refined(own, nominal) if len(inside) > 1 else nominal
    fit = fit_of(own, poses)
    went = [_went(*three) for three in zip(poses, nominal, own, strict=True)]
    faults = _faults(own, went, fit)
    placed = {}
    for k, v in enumerate(inside):
        moved, turned = went[k]
        placed[v] = Placed(
            name=held[v].name,
            pose=poses[k],
            points=len(held[v].xyz),
            flying=held[v].flying,
            before=float(before.apart[v]),
            after=float(fit.apart[k]),
            agree=float(fit.agree[k]),
            moved=moved,
            turned=math.degrees(turned),
            refused=faults[k][1],
        )
    return placed, [fault[0] for fault in faults]


def _went(pose: RigidMotion, before: RigidMotion, own: Threads) -> tuple[float, float]:
    """How far a view was moved, metres, and turned, radians."""
    moved = np.linalg.norm(pose.apply(own.held) - before.apply(own.held))
    return float(moved), float(np.linalg.norm(turn_of(pose, before)))


def _faults(own: list[Threads], went: list[tuple[float, float]], fit: Fit) -> list[_Fault]:
    """How far each view is beyond what is allowed (1 = just so), and in words ("" = it fits).

    A view alone has no fault.
    """
    found = []
    for k, (moved, turned) in enumerate(went):
        others = np.arange(len(own)) != k
        apart, agree = float(fit.apart[k]), float(fit.agree[k])
        wanted = np.fmax(MIN_AGREEMENT_SHARE * _median(fit.agree[others]), MIN_AGREEMENT)
        faults = [
            (
                math.inf if len(own[k]) < MIN_SAMPLES else 0.0,
                f"only {len(own[k])} samples of branches seen",
            ),
            (moved / (MAX_MOVE * MOVED), f"moved by {1000 * moved:.0f} mm"),
            (turned / (MAX_MOVE * TURNED), f"turned by {math.degrees(turned):.1f} degrees"),
            (float(wanted) / max(agree, TINY), f"{agree:.0%} confirmed by the views near it"),
            (
                apart / (MAX_DISTANCE_SHARE * _median(fit.apart[others])),
                f"{1000 * apart:.1f} mm from others",
            ),
        ]
        worst = max(fault for fault in faults if not math.isnan(fault[0]))
        found.append(worst if worst[0] > 1 and others.any() else (0.0, ""))
    return found


def _median(values: Floats) -> float:
    """The median of what is known; NaN where nothing is."""
    known = values[np.isfinite(values)]
    return float(np.median(known)) if len(known) else math.nan


def _one_each(xyz: Floats, rng: np.random.Generator) -> Ints:
    """Rows of xyz (P, 3): one, drawn at random, in each cube of side `VOXEL_M`."""
    order = rng.permutation(len(xyz))
    return np.sort(order[np.unique(cubes(xyz[order], VOXEL_M), return_index=True)[1]])
