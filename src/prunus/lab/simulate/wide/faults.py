"""What goes wrong in any scan: noise, stations misplaced, holes, cut-offs, strays, few points."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from prunus.lab.simulate.row import NONE
from prunus.lab.simulate.wide.scanners import MILLI, Seen
from prunus.lab.simulate.wide.settings import Faults, even, happens, log_even, whole
from prunus.model import Bools, Floats
from prunus.model.rotations import turned


def spoiled(rng: np.random.Generator, seen: Seen, faults: Faults) -> Seen:
    """The scan with all faults drawn for it."""
    seen = replace(seen, xyz=_misplaced(rng, seen, faults))
    noise = MILLI * log_even(rng, faults.noise_mm)
    seen = replace(seen, xyz=seen.xyz + rng.normal(0, noise, seen.xyz.shape))
    seen = _take(seen, _outside_holes(rng, seen.xyz, faults) & _not_cut_off(rng, seen.xyz, faults))
    return _thinned(rng, _with_strays(rng, seen, faults), faults)


def _take(seen: Seen, kept: Bools) -> Seen:
    return Seen(xyz=seen.xyz[kept], piece=seen.piece[kept], station=seen.station[kept])


def _misplaced(rng: np.random.Generator, seen: Seen, faults: Faults) -> Floats:
    """The points as stations register that are a little turned and moved."""
    stations = int(seen.station.max(initial=0)) + 1
    if stations == 1:
        return seen.xyz
    moved = MILLI * even(rng, faults.misplaced_mm) * rng.normal(size=(stations, 3))
    angle = np.radians(even(rng, faults.misturned))
    xyz, middle = seen.xyz.copy(), seen.xyz.mean(axis=0)
    for station in range(stations):
        own = seen.station == station
        turn = turned(angle * rng.normal(size=3))
        xyz[own] = (xyz[own] - middle) @ turn.T + middle + moved[station]
    return xyz


def _outside_holes(rng: np.random.Generator, xyz: Floats, faults: Faults) -> Bools:
    kept = np.ones(len(xyz), np.bool_)
    if len(xyz) == 0 or not happens(rng, faults.holed):
        return kept
    for _ in range(whole(rng, faults.holes)):
        centre = xyz[rng.integers(len(xyz))]
        kept &= ((xyz - centre) ** 2).sum(axis=1) > even(rng, faults.hole) ** 2
    return kept


def _not_cut_off(rng: np.random.Generator, xyz: Floats, faults: Faults) -> Bools:
    """The points on this side of a plane: the field of view ends at the left, right or top."""
    if len(xyz) == 0 or not happens(rng, faults.cut):
        return np.ones(len(xyz), np.bool_)
    side = np.array([[1.0, 0, 0], [-1.0, 0, 0], [0, 0, 1.0]])[rng.integers(3)]
    along = xyz @ side
    edge = along.max() - even(rng, faults.cut_off) * np.ptp(along)
    return np.asarray(along <= edge)


def _with_strays(rng: np.random.Generator, seen: Seen, faults: Faults) -> Seen:
    count = round(even(rng, faults.strays) * len(seen.xyz))
    if count == 0:
        return seen
    strays = rng.uniform(seen.xyz.min(axis=0), seen.xyz.max(axis=0), (count, 3))
    return Seen(
        xyz=np.concatenate([seen.xyz, strays]),
        piece=np.concatenate([seen.piece, np.full(count, NONE)]),
        station=np.concatenate([seen.station, np.zeros(count, np.int64)]),
    )


def _thinned(rng: np.random.Generator, seen: Seen, faults: Faults) -> Seen:
    """At most so many points as are drawn for the scan."""
    most = round(log_even(rng, faults.points))
    if len(seen.xyz) <= most:
        return seen
    kept = np.zeros(len(seen.xyz), np.bool_)
    kept[rng.choice(len(seen.xyz), most, replace=False, shuffle=False)] = True
    return _take(seen, kept)
