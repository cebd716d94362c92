"""What each point of a scan was taken for, as a PLY of all points with a property `kind`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prunus.errors import OptionError, PrunusError
from prunus.files.safely import read_bytes, write_bytes
from prunus.io.clouds.cloud_file import WRITTEN, FileCloud, columns_of
from prunus.io.ply import ply_bytes, read_ply, table_of
from prunus.model import Bools, Ints, Kind

KINDS = ", ".join(f"{kind.value} {kind.name.lower()}" for kind in Kind)
"""The classes in words, as files have them."""


def write_classes(path: Path, file: FileCloud, kind: NDArray[Any]) -> None:
    """Write all points of a file as PLY, with the class (P,) of each as property `kind`."""
    check_ply(path)
    columns = columns_of(file.xyz, file.rgb) | {"kind": kind.astype(np.uint8)}
    write_bytes(path, ply_bytes({"vertex": table_of(columns)}, [WRITTEN, f"kind: {KINDS}"]))


def check_ply(path: Path) -> None:
    """Raise OptionError where a file is not called as one of classes is."""
    if path.suffix.lower() != ".ply":
        raise OptionError(f"{path}: classes are written as .ply")


def kinds_of(path: Path, points: int) -> Ints:
    """What each point (P,) of a scan of so many is. PrunusError where the file is none of it."""
    vertex = read_ply(read_bytes(path), path)["vertex"]
    if "kind" not in (vertex.dtype.names or ()) or len(vertex) != points:
        raise PrunusError(
            f"{path}: {len(vertex)} points; expected {points}, each with its `kind`, as "
            "`prunus isolate --classes` writes them"
        )
    return np.asarray(vertex["kind"], np.int64)


def target_of(path: Path, points: int) -> Bools:
    """Which points (P,) of a scan of so many are the tree.

    PrunusError where the file is none of that scan, or leaves none.
    """
    target = np.asarray(kinds_of(path, points) == Kind.TARGET)
    if not target.any():
        raise PrunusError(f"{path}: no point of it is the tree; expected some")
    return target
