"""`python -m bench.plausible [--trees 22] [--others 4]`: what tells a tree from what is none.

The default chain on simulated scans, of which nothing was learned, and on drawn clouds of what is
no tree (`bench.nontrees`). Of trees of the wide orchard the points of one alone, the whole scan,
and that with a base by hand and nothing taken out; of our orchard the same, one laid on its side,
and some with coordinates in steps. Printed are a line a cloud (what `prunus.frames.plausible` and
`prunus.frames.diagnosis` go by), then quantiles of all numbers: the limits there are set by these.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from bench.nontrees import NO_TREES
from prunus.errors import NoTreeError, PrunusError
from prunus.frames.diagnosis import linear_wood, spacing, spread
from prunus.frames.plausible import Evidence
from prunus.lab.simulate.scan import simulate_scan
from prunus.lab.simulate.wide.scan import simulate_wide
from prunus.model import Bools, Floats, Kind, PointCloud
from prunus.pipeline import follow
from prunus.result import Result

SHOWN = 2000
"""A scan with fewer points of a tree does not show it."""
STEPS = (0.02, 0.04, 0.06)
"""Coordinates are rounded to these, metres."""
QUANTILES = (0, 0.02, 0.05, 0.1, 0.5, 0.9, 1)
Record = dict[str, float]


class Drawn(NamedTuple):
    """A cloud: what it is, points (P, 3), which of them (P,) are the tree.

    base (3,): given by hand to the whole scan, of which nothing is taken out then.
    """

    name: str
    xyz: Floats
    own: Bools
    base: Floats | None = None


def trees(count: int, wide: int, ours: int) -> Iterator[Drawn]:
    """Scans of trees, from two first seeds on."""
    for seed in range(wide, wide + count):
        scan = simulate_wide(seed)
        own = scan.kind == Kind.TARGET
        if own.sum() >= SHOWN:
            yield Drawn(f"wide alone {seed}", scan.xyz[own], own[own])
            yield Drawn(f"wide whole {seed}", scan.xyz, own)
            yield Drawn(f"wide as it is {seed}", scan.xyz, own, scan.truth.xyz[0])
    for seed in range(ours, ours + count):
        for setting in ("hard", "clean"):
            scan = simulate_scan(seed, setting)
            own = scan.kind == Kind.TARGET
            alone = scan.xyz[own]
            yield Drawn(f"{setting} alone {seed}", alone, own[own])
            if setting == "hard":
                turned = alone[:, [(1, 2, 0), (0, 2, 1)][seed % 2]]
                yield Drawn(f"hard whole {seed}", scan.xyz, own)
                yield Drawn(f"hard as it is {seed}", scan.xyz, own, scan.truth.xyz[0])
                yield Drawn(f"lying {seed}", turned, own[own])


def rounded(count: int, ours: int) -> Iterator[Drawn]:
    """Clean scans of trees whose coordinates come in steps."""
    for seed in range(ours, ours + count):
        scan = simulate_scan(seed, "clean")
        own = scan.kind == Kind.TARGET
        for step in STEPS:
            xyz = np.round(scan.xyz[own] / step) * step
            yield Drawn(f"in steps of {step * 100:.0f} cm {seed}", np.asarray(xyz), own[own])


def others(count: int, seed: int) -> Iterator[Drawn]:
    """Clouds of what is no tree."""
    for name, draw in NO_TREES.items():
        for number in range(seed, seed + count):
            xyz = draw(np.random.default_rng(number))
            yield Drawn(f"{name} {number}", xyz, np.zeros(len(xyz), np.bool_))


def seen(drawn: Drawn) -> Record:
    """The numbers of a cloud, and whether it is refused."""
    xyz, cloud = drawn.xyz, PointCloud.from_xyz(drawn.xyz)
    off_plane, off_line, _ = spread(xyz)
    record = {"off plane": float(off_plane), "off line": float(off_line), "wood": linear_wood(xyz),
              "spacing": spacing(xyz), "size": float(np.ptp(xyz, axis=0).max())}  # fmt: skip
    try:
        isolate = "auto" if drawn.base is None else "never"
        result = follow(cloud, drawn.base, {"isolation": {"isolate": isolate}})
    except PrunusError:
        return record | {"refused": 1.0, "nothing": 1.0}
    return record | {"nothing": 0.0} | found(result, drawn.own)


def found(result: Result, own: Bools) -> Record:
    """The numbers in what the chain found."""
    evidence = Evidence.of(result)
    record = {name: float(value) for name, value in vars(evidence).items()}
    trust = result.trust
    for name in ("tree", "wood", "form", "meant"):
        record[f"trust, {name}"] = 0.0 if trust is None else float(getattr(trust, name))
    if result.isolated is not None:
        record["kept"] = float(result.isolated.target[own].mean()) if own.any() else 0.0
    try:
        evidence.check()
    except NoTreeError:
        return record | {"refused": 1.0}
    return record | {"refused": 0.0, "doubts": float(len(evidence.doubts()))}


def shown(clouds: Iterator[Drawn]) -> dict[str, list[Record]]:
    """The records by what they are of; printed as they come."""
    by: dict[str, list[Record]] = {}
    for drawn in clouds:
        record = seen(drawn)
        by.setdefault(drawn.name.rsplit(" ", 1)[0], []).append(record)
        print(f"{drawn.name}:", ", ".join(f"{key} {value:.4g}" for key, value in record.items()),
              flush=True)  # fmt: skip
    return by


def main() -> None:
    """Measure, and print."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--trees", type=int, default=22)
    parser.add_argument("--others", type=int, default=4)
    parser.add_argument("--wide", type=int, default=2_000_000)
    parser.add_argument("--ours", type=int, default=990_000)
    chosen = parser.parse_args()
    by = shown(others(chosen.others, 0)) | shown(trees(chosen.trees, chosen.wide, chosen.ours))
    by |= shown(rounded(min(6, chosen.trees), chosen.ours))
    print("\nquantiles", *QUANTILES)
    for what, records in by.items():
        print(f"{what}: {len(records)}")
        for name in dict.fromkeys(key for record in records for key in record):
            values = [record[name] for record in records if name in record]
            print(f"  {name:12}", *(f"{at:8.3g}" for at in np.quantile(values, QUANTILES)),
                  f"  of {len(values)}")  # fmt: skip


if __name__ == "__main__":
    main()
