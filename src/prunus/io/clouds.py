"""Point clouds from files: PLY, PCD, XYZ / TXT / CSV, LAS / LAZ, NPY, NPZ, and ROS bags."""

from __future__ import annotations

import hashlib
import io
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from prunus.errors import OptionError, PrunusError
from prunus.io.bags import read_bag
from prunus.io.inputs import BAGS, Source, is_bag, source_of
from prunus.io.ply import ply_bytes, table_of
from prunus.io.readers import READERS
from prunus.io.safely import digest_of, read_bytes, write_bytes
from prunus.model import Floats
from prunus.model.arrays import Bytes

UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001}
"""Metres in one unit."""

PLAUSIBLE = 50.0
"""A scan wider than so many metres is not in metres, unless `unit` says so."""
PLAUSIBLE_CM = 600.0
"""A scan wider than so many units is not in centimetres either."""


@dataclass(frozen=True, eq=False)
class FileCloud:
    """What a file holds: xyz (P, 3) in metres in its own frame, rgb (P, 3) or None, its sha256.

    `name` is the last part of the path, of a bag with the topic that was asked for.
    """

    path: Path
    xyz: Floats
    rgb: Bytes | None
    sha256: str
    notes: list[str]

    @property
    def name(self) -> str:
        """What the file is called where it is shown and written down."""
        return source_of(self.path).name


def read_cloud(path: str | Path, unit: str | None = None) -> FileCloud:
    """Read a cloud; `unit` (m, cm, mm) is that of the file, None = metres and checked.

    A bag, `bag.mcap#/topic` and the folder of one tree are read too (see docs/inputs.md).
    Raises PrunusError naming the file, what was found and what was expected.
    """
    if unit is not None and unit not in UNITS:
        raise PrunusError(f"unknown unit {unit!r}; expected one of {sorted(UNITS)}")
    source = source_of(Path(path))
    if is_bag(source.path):
        return _read_bag(source, UNITS[unit or "m"])
    return _read_file(source.path, unit)


def _read_bag(source: Source, metres: float) -> FileCloud:
    xyz, rgb, notes = read_bag(source)
    xyz, rgb, _ = _finite(xyz, rgb, source.full)
    return FileCloud(source.full, xyz * metres, rgb, digest_of(source.path), notes)


def _read_file(path: Path, unit: str | None) -> FileCloud:
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        expected = " ".join([*READERS, *BAGS])
        raise PrunusError(
            f"{path}: unknown kind of file {path.suffix!r}; expected one of {expected}"
        )
    content = read_bytes(path)
    xyz, rgb = reader(content, path)
    xyz, rgb, notes = _finite(xyz, rgb, path)
    if unit is None:
        _check_metres(xyz, path)
    xyz = xyz * UNITS[unit or "m"] if unit not in (None, "m") else xyz
    return FileCloud(path, xyz, rgb, hashlib.sha256(content).hexdigest(), notes)


def write_cloud(path: str | Path, xyz: Floats, rgb: Bytes | None = None) -> None:
    """Write a cloud as PLY, XYZ / TXT / CSV, NPY or NPZ by the ending; metres, double precision."""
    path = Path(path)
    check_kind(path)
    write_bytes(path, WRITERS[path.suffix.lower()](xyz, rgb))


def check_kind(path: Path) -> None:
    """Raise OptionError where the ending of a file is none of a cloud that can be written."""
    if path.suffix.lower() not in WRITERS:
        raise OptionError(
            f"{path}: clouds are not written as {path.suffix!r}; "
            f"expected one of {' '.join(WRITERS)}"
        )


def _finite(xyz: Floats, rgb: Bytes | None, path: Path) -> tuple[Floats, Bytes | None, list[str]]:
    if len(xyz) == 0:
        raise PrunusError(f"{path}: holds no points; expected at least one")
    if np.isfinite(xyz.sum()):
        return xyz, rgb, []
    finite = np.isfinite(xyz)
    nothing = np.isnan(xyz).all(axis=1)
    if path.suffix.lower() == ".pcd" and nothing.any():
        kept = ~nothing
        notes = [f"{nothing.sum()} of {len(xyz)} pixels saw nothing (NaN) and were left out"]
        rest, colours, _ = _finite(xyz[kept], None if rgb is None else rgb[kept], path)
        return rest, colours, notes
    bad = ~finite.all(axis=1)
    if not bad.any():
        return xyz, rgb, []
    raise PrunusError(
        f"{path}: {bad.sum()} of {len(xyz)} points hold NaN or infinity (the first is point "
        f"{int(bad.argmax()) + 1}); expected finite coordinates"
    )


def _check_metres(xyz: Floats, path: Path) -> None:
    step = max(1, len(xyz) // 20_000)
    low, high = np.quantile(xyz[::step], [0.02, 0.98], axis=0)
    wide = float((high - low).max())
    if wide <= PLAUSIBLE:
        return
    unit, name = ("cm", "centimetres") if wide <= PLAUSIBLE_CM else ("mm", "millimetres")
    raise PrunusError(
        f"{path}: the scan is {wide:.0f} units wide, expected a tree in metres; it looks like "
        f"{name}: say --unit {unit} (or --unit m if it is in metres all the same)"
    )


WRITTEN = "written by prunus; unit: metre"
"""What the PLY files of clouds say of themselves."""


def columns_of(xyz: Floats, rgb: Bytes | None) -> dict[str, Any]:
    """Points (P, 3), and their colours (P, 3) where they have any, as the columns of a PLY."""
    columns: dict[str, Any] = {name: xyz[:, axis] for axis, name in enumerate("xyz")}
    if rgb is not None:
        columns |= {name: rgb[:, c] for c, name in enumerate(("red", "green", "blue"))}
    return columns


def _ply(xyz: Floats, rgb: Bytes | None) -> bytes:
    return ply_bytes({"vertex": table_of(columns_of(xyz, rgb))}, [WRITTEN])


def _text(delimiter: str) -> Callable[[Floats, Bytes | None], bytes]:
    def write(xyz: Floats, rgb: Bytes | None) -> bytes:
        rows = xyz if rgb is None else np.column_stack([xyz, rgb])
        header = delimiter.join(["x", "y", "z", "r", "g", "b"][: rows.shape[1]])
        out = io.BytesIO()
        np.savetxt(out, rows, "%.12g" if rgb is None else ["%.12g"] * 3 + ["%d"] * 3, delimiter)
        return header.encode() * (delimiter == ",") + b"\n" * (delimiter == ",") + out.getvalue()

    return write


def _npy(xyz: Floats, _: Bytes | None) -> bytes:
    out = io.BytesIO()
    np.save(out, xyz)
    return out.getvalue()


def _npz(xyz: Floats, rgb: Bytes | None) -> bytes:
    out = io.BytesIO()
    arrays: dict[str, Any] = {"xyz": xyz} if rgb is None else {"xyz": xyz, "rgb": rgb}
    np.savez_compressed(out, **arrays)
    return out.getvalue()


WRITERS: dict[str, Callable[[Floats, Bytes | None], bytes]] = {
    ".ply": _ply,
    ".xyz": _text(" "),
    ".txt": _text(" "),
    ".csv": _text(","),
    ".npy": _npy,
    ".npz": _npz,
}
"""How each kind of file is written, by its ending."""
