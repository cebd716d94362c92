"""Point clouds from files of every kind in docs/inputs.md, and from ROS bags: the one door."""

from __future__ import annotations

import hashlib
import io
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from prunus.errors import OptionError, PrunusError
from prunus.files.safely import digest_of, parsing, read_bytes, write_bytes
from prunus.io.clouds.columns import Content
from prunus.io.clouds.readers import READERS
from prunus.io.clouds.real import check_steps, only_real
from prunus.io.clouds.units import UNITS, metres_in, unit_of
from prunus.io.inputs import BAGS, Source, clouds_in, is_bag, source_of
from prunus.io.ply import ply_bytes, table_of
from prunus.io.ros.bags import read_bag
from prunus.model import Floats
from prunus.model.arrays import Bytes
from prunus.names import as_text

PLAUSIBLE_M = 50.0
"""A scan wider than so many metres is not in metres, unless `unit` says so."""
PLAUSIBLE_TOLD_M = 1000.0
"""Nor is one so wide where a header with a place for the unit says so."""
PLAUSIBLE_CM = 600.0
"""A scan wider than so many units is not in centimetres either."""


@dataclass(frozen=True, eq=False, kw_only=True)
class FileCloud:
    """What a file holds: xyz (P, 3) in metres in its own frame, rgb (P, 3) or None, its sha256.

    `name` is the last part of the path, of a bag with the topic that was asked for. `unit` is what
    the file was read in; `notes` say what was done and left out on the way.
    """

    path: Path
    xyz: Floats
    rgb: Bytes | None
    sha256: str
    notes: list[str]
    unit: str = "m"

    @property
    def name(self) -> str:
        """What the file is called where it is shown and written down."""
        return as_text(source_of(self.path).name)


def read_cloud(path: str | Path, unit: str | None = None) -> FileCloud:
    """Read a cloud; `unit` (m, cm, mm, ft, us-ft, in) is that of the file.

    None: what its header tells, else metres, checked. A bag, `bag.mcap#/topic`, the folder of one
    tree and one of a single cloud are read too (see docs/inputs.md).
    Raises PrunusError naming the file, what was found and what was expected.
    """
    asked = None if unit is None else metres_in(unit)
    source = source_of(Path(path))
    if is_bag(source.path):
        with np.errstate(all="ignore"):
            xyz, rgb, notes = read_bag(source)
        held = only_real(Content(xyz=xyz, rgb=rgb, notes=notes), source.full)
        sha256 = digest_of(source.path)
    else:
        content = _file_of(source.path)
        sha256 = hashlib.sha256(content).hexdigest()
        with parsing(source.path, _kind_of(source.path)), np.errstate(all="ignore"):
            held = READERS[source.path.suffix.lower()](content, source.path)
        held = only_real(held, source.full)
    metres, notes = _metres(held, asked, source)
    notes += check_steps(held.xyz, metres, source.full)
    xyz = held.xyz if metres == 1 else held.xyz * metres
    return FileCloud(
        path=source.full,
        xyz=xyz,
        rgb=held.rgb,
        sha256=sha256,
        notes=[*held.notes, *notes],
        unit=unit_of(metres),
    )


def _file_of(path: Path) -> bytes:
    """The content of a cloud file; PrunusError where the path is none."""
    if path.is_dir():
        raise PrunusError(_not_one(path))
    if path.suffix.lower() not in READERS:
        expected = " ".join([*READERS, *BAGS])
        what = f"unknown kind of file {path.suffix!r}" if path.suffix else "no ending in the name"
        raise PrunusError(f"{path}: {what}; expected one of {expected}")
    return read_bytes(path)


def _not_one(folder: Path) -> str:
    """What is wrong with a folder that stands for no one cloud."""
    try:
        inside = clouds_in(folder)
    except OSError as error:
        return f"{folder}: cannot be read ({error.strerror})"
    names = ", ".join(path.relative_to(folder).as_posix() for path in inside[:9])
    more = ", ..." if len(inside) > 9 else ""
    found = f"{len(inside)} clouds: {names}{more}" if inside else "no cloud"
    return f"{folder}: a folder of {found}; expected one cloud"


def _kind_of(path: Path) -> str:
    ending = path.suffix.lower()
    named = {".npy": "numpy", ".npz": "numpy", ".las": "LAS or LAZ", ".laz": "LAS or LAZ"}
    return f"{named.get(ending, ending[1:].upper())} file"


def _metres(held: Content, asked: float | None, source: Source) -> tuple[float, list[str]]:
    """Metres in one unit of a cloud, and notes on how that is known.

    What is asked for counts before what the header tells; PrunusError where neither is plausible.
    """
    told, path = held.metres, source.full
    if asked is not None:
        unit, notes = unit_of(asked), []
        if held.fault:
            notes.append(f"unit {unit} as asked, but {held.fault}")
        elif told is not None and unit_of(told) != unit:
            notes.append(f"unit {unit} as asked, but the header tells {unit_of(told)}")
        elif asked != 1:
            notes.append(f"unit {unit} as asked: all that is written is in metres")
        return asked, notes
    if held.fault:
        raise PrunusError(
            f"{path}: {held.fault}; expected lengths. Say --unit m if they are metres all the same"
        )
    if not is_bag(source.path):
        _check_width(held, path)
    if told is None or told == 1:
        return 1.0, []
    return told, [f"unit {unit_of(told)}, as the header tells: all that is written is in metres"]


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


def _check_width(held: Content, path: Path) -> None:
    told = held.metres
    step = max(1, len(held.xyz) // 20_000)
    low, high = np.quantile(held.xyz[::step], [0.02, 0.98], axis=0)
    wide = float((high - low).max())
    if wide * (told or 1) <= (PLAUSIBLE_TOLD_M if told and held.sure else PLAUSIBLE_M):
        return
    unit, name = ("cm", "centimetres") if wide <= PLAUSIBLE_CM else ("mm", "millimetres")
    unknown = "expected a tree in metres" if told is None else f"the header tells {unit_of(told)}"
    raise PrunusError(
        f"{path}: the scan is {wide:.0f} units wide, {unknown}; it looks like {name}: say "
        f"--unit {unit} (or what it is: {', '.join(UNITS)}; --unit m if metres all the same)"
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
