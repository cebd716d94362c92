"""The examples that the point field learns from, made by the recipe and kept in its folder."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from prunus.files.safely import write_bytes
from prunus.lab.learn.field.examples import FieldExample
from prunus.lab.learn.field.recipe import Scans
from prunus.lab.simulate.scan import Scan, simulate_scan
from prunus.lab.simulate.wide.scan import simulate_wide
from prunus.processes.workers import in_order

FEWEST_POINTS = 2000  # a scan of fewer is left out
LEFT_OUT = ".left-out"
STREAM = {"wide": 7, "rig": 8}  # so that the points kept are drawn independently of the scans
Orchard = Literal["wide", "rig"]


@dataclass(frozen=True)
class Made:
    """A scan to make: the file of its example, the orchard, its seed and its number there."""

    path: Path
    orchard: Orchard
    seed: int
    number: int
    clean: bool = False

    @property
    def left_out(self) -> Path:
        """The file that says that the scan has too few points."""
        return self.path.with_suffix(LEFT_OUT)

    @property
    def done(self) -> bool:
        """Whether it is made already."""
        return self.path.exists() or self.left_out.exists()

    def scan(self) -> Scan:
        """The scan."""
        if self.orchard == "wide":
            return simulate_wide(self.seed)
        return simulate_scan(self.seed, "clean" if self.clean else "hard")


def examples_to_make(folder: Path, scans: Scans) -> list[Made]:
    """What there is to make in a folder, whether it is made or not."""
    rig = (
        Made(folder / f"r{seed:06d}.npz", "rig", seed, number, scans.is_clean(number))
        for number, seed in enumerate(scans.rig_seeds)
    )
    wide = (
        Made(folder / f"w{seed:06d}.npz", "wide", seed, number)
        for number, seed in enumerate(scans.wide_seeds)
    )
    return [*rig, *wide]


def make_examples(missing: Sequence[Made], jobs: int) -> Iterator[None]:
    """Make examples, so many at a time."""
    yield from in_order(_make, missing, jobs)


def _make(own: Made) -> None:
    rng = np.random.default_rng([own.number, STREAM[own.orchard]])
    example = FieldExample.of(own.scan(), rng)
    if len(example.xyz) < FEWEST_POINTS:
        write_bytes(own.left_out, f"{len(example.xyz)} points\n".encode())
    else:
        example.write(own.path)
