"""`prunus isolate`: one tree out of a raw scan, all of them, or a list of what is in view."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from prunus.errors import PrunusError
from prunus.intake import Scan, open_scan
from prunus.io.classes import check_ply, write_classes
from prunus.io.clouds import FileCloud, check_kind, write_cloud
from prunus.model import Floats
from prunus.params import Parameters
from prunus.sensing.isolate import Isolated, Scene, check_at, isolate, look_at


@dataclass(frozen=True, eq=False)
class Opened:
    """A raw scan from a file, and what isolation sees in it."""

    scan: Scan
    scene: Scene

    @classmethod
    def of(cls, path: Path, frame: str, unit: str | None, seed: int) -> Opened:
        """Read a file and look at it. PrunusError naming it where it is none."""
        scan = open_scan(path, frame, unit)
        try:
            return cls(scan, look_at(scan.cloud, Parameters(), np.random.default_rng(seed)))
        except PrunusError as error:
            raise PrunusError(f"{path}: {error}") from error

    def place(self, point: Floats) -> Floats:
        """A point of the house frame (3,) in the frame of the file."""
        return self.scan.cloud.to_input.apply(point)

    def tree_at(self, at: tuple[float, float, float] | None) -> Isolated:
        """The tree at a point of the file's frame; None: the likeliest."""
        try:
            point = None
            if at is not None:
                point = self.scan.cloud.to_input.inverse().apply(at)
                check_at(self.scene, point)
            return isolate(self.scene, point)
        except PrunusError as error:
            raise PrunusError(f"{self.scan.file.path}: {error}") from error


def check_output(path: Path, classes: bool) -> None:
    """Raise OptionError where the ending of a file is none that can be written."""
    if classes:
        check_ply(path)
    else:
        check_kind(path)


def write_tree(
    opened: Opened, output: Path, at: tuple[float, float, float] | None, classes: bool
) -> list[str]:
    """Write the tree at a point, or all points with their classes; what to say of it."""
    isolated = opened.tree_at(at)
    _write(output, opened.scan.file, isolated, classes)
    return [*opened.scan.notes, _standing(opened, isolated), isolated.told()]


def write_all(opened: Opened, output: Path, classes: bool) -> list[str]:
    """Write every tree in view as OUTPUT_1, OUTPUT_2, ...; what to say of them."""
    lines = []
    for number, isolated in enumerate(_trees(opened), 1):
        path = output.with_stem(f"{output.stem}_{number}")
        _write(path, opened.scan.file, isolated, classes)
        lines.append(f"{path}: {isolated.target.sum()} points; {_standing(opened, isolated)}")
    return [*opened.scan.notes, *lines]


def list_trees(opened: Opened) -> list[str]:
    """The trees in view, a line each, with a point to give to --at."""
    lines = []
    for number, isolated in enumerate(_trees(opened), 1):
        at = " ".join(f"{value:.2f}" for value in opened.place(isolated.foot))
        height = float(np.ptp(opened.scan.cloud.xyz[isolated.target, 2]))
        about = f"{isolated.target.sum():>7} points, {height:.1f} m high"
        lines.append(f"{number}  --at {at}  {about}{'  (taken without --at)' * (number == 1)}")
    return lines


def _trees(opened: Opened) -> list[Isolated]:
    if not opened.scene.trees:
        path = opened.scan.file.path
        raise PrunusError(f"{path}: no trunk in view; expected one, Z up and in metres")
    return opened.scene.trees


def _standing(opened: Opened, isolated: Isolated) -> str:
    place = ", ".join(f"{value:.2f}" for value in opened.place(isolated.foot))
    return f"the foot of its trunk is at ({place})"


def _write(path: Path, file: FileCloud, isolated: Isolated, classes: bool) -> None:
    if classes:
        write_classes(path, file, isolated.kind)
        return
    held = isolated.target
    write_cloud(path, file.xyz[held], None if file.rgb is None else file.rgb[held])
