"""From a file to a cloud in the house frame: unit, frame, local origin."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from prunus.errors import PrunusError
from prunus.io.clouds import FileCloud
from prunus.io.clouds import read_cloud as read_file
from prunus.io.safely import path_of
from prunus.model import FRAMES, PointCloud
from prunus.sensing.level import find_turn
from prunus.sensing.orient import find_frame, local_wood


@dataclass(frozen=True, eq=False)
class Scan:
    """A cloud in the house frame, the file it came from, and notes on how it was read."""

    cloud: PointCloud
    file: FileCloud
    frame: str
    notes: list[str]

    @property
    def record(self) -> dict[str, Any]:
        """What files say of the input they came from."""
        return {"file": self.file.name, "sha256": self.file.sha256, "points": len(self.cloud)}


def open_scan(path: str | Path, frame: str = "auto", unit: str | None = None) -> Scan:
    """Read a file. frame: z-up, optical, or auto = by the evidence in the cloud; unit: m, cm, mm.

    Raises PrunusError naming the file, what was found and what was expected.
    """
    if not isinstance(frame, str) or frame not in (*FRAMES, "auto"):
        raise PrunusError(f"unknown frame {frame!r}; expected auto, {', '.join(FRAMES)}")
    if not isinstance(unit, str | None):
        raise PrunusError(f"unknown unit {unit!r}; expected text")
    file = read_file(path_of(path), unit)
    notes = list(file.notes)
    wood = local_wood(file.xyz)
    seems, why = find_frame(wood)
    turn = None
    if frame == "auto":
        frame = seems
        notes.append(f"frame {frame}: {why}")
        to_house = FRAMES[frame]
        in_house = file.xyz @ to_house.T
        turn, turned = find_turn(in_house, wood.turned(to_house), np.random.default_rng(0))
        notes += turned
    elif seems != frame and not why.startswith("undecided"):
        notes.append(f"frame {frame} as asked, but the cloud looks like {seems}: {why}")
    return Scan(PointCloud.from_xyz(file.xyz, frame, file.rgb, turn), file, frame, notes)


def read_cloud(path: str | Path, frame: str = "auto", unit: str | None = None) -> PointCloud:
    """Read a cloud into the house frame (see `open_scan`)."""
    return open_scan(path, frame, unit).cloud
