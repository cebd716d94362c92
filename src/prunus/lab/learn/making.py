"""The examples that a network learns from, made by the recipe and kept in its folder."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Literal, Protocol, Self

import numpy as np

from prunus.files.safely import write_bytes
from prunus.lab.learn.recipe import Scans
from prunus.lab.simulate.scan import Scan, simulate_scan
from prunus.lab.simulate.wide.scan import simulate_wide
from prunus.processes.workers import in_order

LEFT_OUT = ".left-out"
STREAM = {"wide": 7, "rig": 8}  # so that the points kept are drawn independently of the scans
Orchard = Literal["wide", "rig"]


class Example(Protocol):
    """What is kept of a scan to learn from."""

    @classmethod
    def of(cls, scan: Scan, rng: np.random.Generator) -> Self:
        """The example of a simulated scan."""

    @property
    def lacks(self) -> str | None:
        """Why nothing can be learned from it, None where something can."""

    def write(self, path: Path) -> None:
        """Keep it."""


@dataclass(frozen=True, kw_only=True)
class Made:
    """A scan to make: the file of its example, the orchard, its seed and its number there."""

    path: Path
    orchard: Orchard
    seed: int
    number: int
    clean: bool = False

    @property
    def left_out(self) -> Path:
        """The file that says why nothing can be learned from the scan."""
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
        Made(
            path=folder / f"r{seed:06d}.npz",
            orchard="rig",
            seed=seed,
            number=number,
            clean=scans.is_clean(number),
        )
        for number, seed in enumerate(scans.rig_seeds)
    )
    wide = (
        Made(path=folder / f"w{seed:06d}.npz", orchard="wide", seed=seed, number=number)
        for number, seed in enumerate(scans.wide_seeds)
    )
    return [*rig, *wide]


def make_examples(missing: Sequence[Made], kind: type[Example], jobs: int) -> Iterator[None]:
    """Make examples of a kind, so many at a time."""
    yield from in_order(partial(_make, kind), missing, jobs)


def _make(kind: type[Example], own: Made) -> None:
    rng = np.random.default_rng([own.number, STREAM[own.orchard]])
    example = kind.of(own.scan(), rng)
    if example.lacks:
        write_bytes(own.left_out, f"{example.lacks}\n".encode())
    else:
        example.write(own.path)
