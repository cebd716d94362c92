"""`prunus isolate`: one tree out of a raw scan, all of them, or a list of what is in view."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from prunus.errors import NoTreeError, naming
from prunus.intake import Scan, open_scan
from prunus.io.classes import check_ply, write_classes
from prunus.io.clouds import FileCloud, check_kind, write_cloud
from prunus.model import Floats
from prunus.params import Parameters
from prunus.plausible import LEAST_LINEAR
from prunus.sensing.diagnosis import explaining
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
        with naming(path), explaining(scan.cloud):
            return cls(scan, look_at(scan.cloud, Parameters(), np.random.default_rng(seed)))

    def place(self, point: Floats) -> Floats:
        """A point of the house frame (3,) in the frame of the file."""
        return self.scan.cloud.to_input.apply(point)

    def tree_at(self, at: tuple[float, float, float] | None) -> Isolated:
        """The tree at a point of the file's frame; None: the likeliest. NoTreeError: it is none."""
        with naming(self.scan.file.path), explaining(self.scan.cloud):
            point = None
            if at is not None:
                point = self.scan.cloud.to_input.inverse().apply(at)
                check_at(self.scene, point)
            found = isolate(self.scene, point)
            if not self.has_branches(found):
                raise NoTreeError("no tree was found, but a surface or a heap")
            return found

    def trees(self) -> list[Isolated]:
        """The trees in view, the likeliest first; NoTreeError where there is none."""
        with naming(self.scan.file.path), explaining(self.scan.cloud):
            found = [tree for tree in self.scene.trees if self.has_branches(tree)]
            if not found:
                raise NoTreeError("no tree was found: no trunk with branches is in view")
            return found

    def has_branches(self, tree: Isolated) -> bool:
        """Whether what was taken for a tree looks like branches."""
        return self.scene.linearity(tree) >= LEAST_LINEAR


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
    said = [_standing(opened, isolated), isolated.told(), *isolated.doubts()]
    return [*opened.scan.notes, *said]


def write_all(opened: Opened, output: Path, classes: bool) -> list[str]:
    """Write every tree in view as OUTPUT_1, OUTPUT_2, ...; what to say of them."""
    lines, trees = [], opened.trees()
    for number, isolated in enumerate(trees, 1):
        path = _numbered(output, number)
        _write(path, opened.scan.file, isolated, classes)
        lines.append(f"{path}: {isolated.target.sum()} points; {_standing(opened, isolated)}")
    older = _numbered(output, len(trees) + 1)
    if older.exists():
        lines.append(f"{older}: was there before; it is no tree of this scan")
    return [*opened.scan.notes, *lines]


def _numbered(output: Path, number: int) -> Path:
    return output.with_stem(f"{output.stem}_{number}")


def list_trees(opened: Opened) -> list[str]:
    """The trees in view, a line each, with a point to give to --at."""
    lines = []
    for number, isolated in enumerate(opened.trees(), 1):
        at = " ".join(f"{value:.2f}" for value in opened.place(isolated.foot))
        height = float(np.ptp(opened.scan.cloud.xyz[isolated.target, 2]))
        about = f"{isolated.target.sum():>7} points, {height:.1f} m high"
        lines.append(f"{number}  --at {at}  {about}{'  (taken without --at)' * (number == 1)}")
    return lines


def _standing(opened: Opened, isolated: Isolated) -> str:
    place = ", ".join(f"{value:.2f}" for value in opened.place(isolated.foot))
    return f"the foot of its trunk is at ({place})"


def _write(path: Path, file: FileCloud, isolated: Isolated, classes: bool) -> None:
    if classes:
        write_classes(path, file, isolated.kind)
        return
    held = isolated.target
    write_cloud(path, file.xyz[held], None if file.rgb is None else file.rgb[held])
