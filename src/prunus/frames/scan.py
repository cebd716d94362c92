"""From a file to a cloud in the house frame: unit, frame, local origin."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from prunus.errors import PrunusError
from prunus.files.safely import path_of
from prunus.frames.stance import Stance, find_stance
from prunus.frames.upright import surest_frame
from prunus.io.clouds.cloud_file import FileCloud
from prunus.io.clouds.cloud_file import read_cloud as read_file
from prunus.model import FRAMES, Floats, PointCloud


@dataclass(frozen=True, eq=False, kw_only=True)
class Scan:
    """A cloud in the house frame, the file it came from, and notes on how it was read.

    `frame` is what was found; `asked`: frame and unit as they were asked for.
    """

    cloud: PointCloud
    file: FileCloud
    frame: str
    notes: list[str]
    asked: tuple[str, str | None] = ("auto", None)

    @property
    def record(self) -> dict[str, Any]:
        """What files say of the input they came from."""
        return {"file": self.file.name, "sha256": self.file.sha256, "points": len(self.cloud)}


def open_scan(path: str | Path, frame: str = "auto", unit: str | None = None) -> Scan:
    """Read a file. frame: one of `FRAMES`, or auto = by the evidence in the cloud; unit: m, cm, mm.

    With `auto` a scan is levelled by its ground. The row is turned to X, where there is evidence of
    one and the frame does not tell it (`ROW_TOLD`). Notes say what was done.

    Raises PrunusError naming the file, what was found and what was expected.
    """
    if not isinstance(frame, str) or frame not in (*FRAMES, "auto"):
        raise PrunusError(f"unknown frame {frame!r}; expected auto, {', '.join(FRAMES)}")
    if not isinstance(unit, str | None):
        raise PrunusError(f"unknown unit {unit!r}; expected text")
    file = read_file(path_of(path), unit)
    stance = _stance(file.xyz, frame)
    cloud = PointCloud.from_xyz(file.xyz, stance.frame, file.rgb, stance.turn)
    notes = [*file.notes, *stance.notes]
    return Scan(cloud=cloud, file=file, frame=stance.frame, notes=notes, asked=(frame, unit))


def read_cloud(path: str | Path, frame: str = "auto", unit: str | None = None) -> PointCloud:
    """Read a cloud into the house frame (see `open_scan`)."""
    return open_scan(path, frame, unit).cloud


def _stance(xyz: Floats, frame: str) -> Stance:
    """How points (P, 3) of a file stand; where that is not plain, as a tree is surest."""
    stance = find_stance(xyz, frame)
    if frame != "auto" or (stance.grounded and not stance.others):
        return stance
    up = FRAMES[stance.frame][2]
    others = dict.fromkeys(
        name for name in (*stance.others, "z-up") if not np.allclose(FRAMES[name][2], up)
    )
    best = surest_frame(xyz, [stance.frame, *others])
    if best == stance.frame:
        return stance
    because = f"frame {best}: a tree is surer in it than in {stance.frame}, as which it looks"
    return find_stance(xyz, best, because)
