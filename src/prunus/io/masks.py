"""`mask.ply`: what each point of a scan is, as a person marked it (written by isolation)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from prunus.errors import PrunusError
from prunus.io.ply import read_ply
from prunus.io.safely import read_bytes
from prunus.model import Bools, Kind


def target_of(path: Path, points: int) -> Bools:
    """Which points (P,) of a scan of so many are the tree.

    PrunusError where the file is none of that scan, or leaves none.
    """
    vertex = read_ply(read_bytes(path), path)["vertex"]
    if "kind" not in (vertex.dtype.names or ()) or len(vertex) != points:
        raise PrunusError(
            f"{path}: {len(vertex)} points; expected {points}, each with its `kind`, as "
            "`prunus isolate --classes` writes them"
        )
    target = np.asarray(vertex["kind"] == Kind.TARGET)
    if not target.any():
        raise PrunusError(f"{path}: no point of it is the tree; expected some")
    return target
