"""`prunus isolate`: one tree out of a raw scan, all of them, or a list of what is in view."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from prunus.errors import NoTreeError, naming
from prunus.frames.diagnosis import explaining
from prunus.frames.linear import linear_of
from prunus.frames.plausible import LEAST_LENGTH_M, LEAST_LINEAR, LEAST_SURE
from prunus.frames.scan import Scan, open_scan
from prunus.frames.upright import sureness
from prunus.growth.chain import View, Votes
from prunus.io.clouds.classes import check_ply, write_classes
from prunus.io.clouds.cloud_file import FileCloud, check_kind, write_cloud
from prunus.model import Floats, Skeleton
from prunus.model.isolated import Isolated
from prunus.params import Parameters


@dataclass(frozen=True, eq=False, kw_only=True)
class Opened:
    """A raw scan from a file, the trees that grow in it, and notes on where one was asked for."""

    scan: Scan
    view: View
    params: Parameters
    rng: np.random.Generator

    @classmethod
    def of(
        cls,
        path: Path,
        frame: str,
        unit: str | None,
        seed: int,
        at: tuple[float, float, float] | None,
        params: Parameters,
    ) -> Opened:
        """Read a file and look at it; meant is the tree at a point of the file's frame.

        PrunusError naming the file where it is none, or the point is far from all wood;
        NoTreeError where nothing is wood.
        """
        scan = open_scan(path, frame, unit)
        with naming(path), explaining(scan.cloud):
            base = None if at is None else scan.cloud.to_input.inverse().apply(at)
            rng = np.random.default_rng(seed)
            view = Votes().look(scan.cloud, base, params, rng, {})
            return cls(scan=scan, view=view, params=params, rng=rng)

    def place(self, point: Floats) -> Floats:
        """A point of the house frame (3,) in the frame of the file."""
        return self.scan.cloud.to_input.apply(point)

    def tree(self) -> Isolated:
        """The tree that is meant; NoTreeError: it is none."""
        with naming(self.scan.file.path), explaining(self.scan.cloud):
            isolated = self._alone(self.view)
            if isolated is None:
                raise NoTreeError("no tree was found: hardly any branches, or a surface or a heap")
            return isolated

    def trees(self) -> list[Isolated]:
        """The trees in view, that which is meant first; NoTreeError where there is none."""
        every = [self._alone(one) for one in self.view.each()]
        found = [own for own in every if own is not None]
        if not found:
            with naming(self.scan.file.path), explaining(self.scan.cloud):
                raise NoTreeError("no tree was found: no foot with branches is in view")
        return found

    def _alone(self, view: View) -> Isolated | None:
        """The tree that is meant in a view, as `skeletonize` takes it; None: it is none."""
        alone = Votes().alone(view, self.params, self.rng, {})
        own = alone.isolated or view.points_of_tree()
        return own if is_tree(alone.tree(), self.scan.cloud.xyz[own.target]) else None


def is_tree(skeleton: Skeleton, xyz: Floats) -> bool:
    """Whether what grew from a foot, of points (P, 3), is enough and sure enough to be a tree."""
    if skeleton.lengths.sum() < LEAST_LENGTH_M or sureness(skeleton) < LEAST_SURE:
        return False
    return linear_of(xyz) >= LEAST_LINEAR


def check_output(path: Path, classes: bool) -> None:
    """Raise OptionError where the ending of a file is none that can be written."""
    if classes:
        check_ply(path)
    else:
        check_kind(path)


def write_tree(opened: Opened, output: Path, classes: bool) -> list[str]:
    """Write the tree that is meant, or all points with their classes; what to say of it."""
    isolated = opened.tree()
    _write(output, opened.scan.file, isolated, classes)
    said = [*opened.view.notes, _standing(opened, isolated), isolated.told()]
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
