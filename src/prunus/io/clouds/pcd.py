"""Point clouds of PCL (`.pcd`, version 0.7 and older): ASCII, binary and compressed.

Written here because packages for it refuse what PCL itself takes: COUNT, VIEWPOINT and POINTS may
be missing.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from prunus.errors import PrunusError
from prunus.files.safely import BYTE_ORDER_MARK
from prunus.io.clouds.columns import Content, content_of, unpacked
from prunus.io.ply import Table

KINDS = {"I": "i", "U": "u", "F": "f"}
"""Types of numbers: signed, unsigned, floating."""
PACKED = ("rgb", "rgba")
"""Fields that hold a colour in four bytes."""
STILL = ["0", "0", "0", "1", "0", "0", "0"]
"""The viewpoint (x y z, quaternion w x y z) of a cloud that was not moved."""
HEADER_BYTES = 2**16
"""No header is longer."""
DENSEST = 100
"""LZF makes at most 264 bytes of three."""


@dataclass(frozen=True, kw_only=True)
class _Header:
    points: int
    row: np.dtype[Any]
    form: str
    body: int
    viewpoint: list[str]


def read_pcd(content: bytes, path: Path) -> Content:
    """Points and colours of a PCD; PrunusError on a wrong header or too few bytes or rows."""
    content = content.removeprefix(BYTE_ORDER_MARK)
    header = _header(content, path)
    read = {"ascii": _ascii, "binary": _binary, "binary_compressed": _compressed}[header.form]
    table = read(content, header, path)
    names = table.dtype.names or ()
    found = content_of(table, names, path)
    packed = next((name for name in names if name.lower() in PACKED), None)
    if found.rgb is None and packed is not None and not table.dtype[packed].shape:
        found = replace(found, rgb=unpacked(table[packed]))
    moved = [float(number) for number in header.viewpoint] != [float(number) for number in STILL]
    if moved:
        found.notes.append("the VIEWPOINT in the header was not applied: points are as they stand")
    return found


def _header(content: bytes, path: Path) -> _Header:
    entries: dict[str, list[str]] = {}
    start = 0
    while "DATA" not in entries and start < min(len(content), HEADER_BYTES):
        end = re.compile(rb"\r\n|\n|\r|$").search(content, start)
        line, start = content[start : end.start()].decode("latin-1"), end.end()  # type: ignore[union-attr]
        key, *words = line.split() or ["#"]
        if not key.startswith("#"):
            entries[key.upper()] = words
    form = "".join(entries.get("DATA", [])).lower()
    if form not in ("ascii", "binary", "binary_compressed"):
        raise PrunusError(
            f"{path}: not a readable PCD file: no line DATA ascii, binary or binary_compressed"
        )
    row = _row_of(entries, path)
    return _Header(
        points=_points(entries, path),
        row=row,
        form=form,
        body=start,
        viewpoint=entries.get("VIEWPOINT") or STILL,
    )


def _row_of(entries: dict[str, list[str]], path: Path) -> np.dtype[Any]:
    """The type of a point, a field of several numbers as such."""
    names = entries.get("FIELDS") or entries.get("COLUMNS") or []
    columns = [entries.get("SIZE", []), entries.get("TYPE", []), entries.get("COUNT")]
    sizes, types, counts = (["1"] * len(names) if c is None else c for c in columns)
    if not names or not len(names) == len(sizes) == len(types) == len(counts):
        raise PrunusError(
            f"{path}: not a readable PCD file: {len(names)} FIELDS, {len(sizes)} SIZE, "
            f"{len(types)} TYPE, {len(counts)} COUNT; expected as many of each"
        )
    fields = list[Any]()
    for number, (name, size, kind, count) in enumerate(
        zip(names, sizes, types, counts, strict=True)
    ):
        code = KINDS.get(kind.upper(), "") + size
        if code not in (
            "i1",
            "i2",
            "i4",
            "i8",
            "u1",
            "u2",
            "u4",
            "u8",
            "f4",
            "f8",
        ) or not re.fullmatch("[0-9]{1,6}", count):
            raise PrunusError(
                f"{path}: not a readable PCD file: the field {name!r} is of TYPE {kind}, "
                f"SIZE {size}, COUNT {count}"
            )
        shape = () if count == "1" else (int(count),)
        fields.append((name if name != "_" else f"_{number}", "<" + code, shape))
    return np.dtype(fields)


def _points(entries: dict[str, list[str]], path: Path) -> int:
    """How many points the header promises; PrunusError where it contradicts itself."""
    told = {key: " ".join(entries[key]) for key in ("WIDTH", "HEIGHT", "POINTS") if key in entries}
    wrong = next((key for key, word in told.items() if not re.fullmatch("[0-9]{1,18}", word)), None)
    if wrong is not None or not told.keys() & {"WIDTH", "POINTS"}:
        key = wrong or "POINTS"
        raise PrunusError(
            f"{path}: not a readable PCD file: {key} is {told.get(key, 'missing')}; "
            "expected a number"
        )
    numbers = {key: int(word) for key, word in told.items()}
    points = numbers.get("POINTS")
    area = numbers["WIDTH"] * numbers.get("HEIGHT", 1) if "WIDTH" in numbers else points
    if points not in (None, area):
        raise PrunusError(
            f"{path}: POINTS is {points}, but WIDTH x HEIGHT {area}; expected the same"
        )
    return int(area or 0)


def _ascii(content: bytes, header: _Header, path: Path) -> Table:
    lines = [line for line in content[header.body :].splitlines() if line.strip()]
    _check(len(lines), header, path)
    if len(lines) > header.points:
        raise PrunusError(f"{path}: {len(lines)} rows; the header promises {header.points} points")
    width = sum(int(np.prod(header.row[name].shape)) for name in header.row.names or ())
    values = np.zeros((0, width))
    if header.points:
        try:
            values = np.loadtxt(lines[: header.points], comments=None, ndmin=2, encoding="latin-1")
        except ValueError as error:
            raise PrunusError(f"{path}: {error}; expected rows of numbers") from error
    if values.shape[1] != width:
        raise PrunusError(f"{path}: rows hold {values.shape[1]} numbers; expected {width}")
    fields = [(name, "<f8", header.row[name].shape) for name in header.row.names or ()]
    return np.ascontiguousarray(values).view(np.dtype(fields)).reshape(-1)


def _binary(content: bytes, header: _Header, path: Path) -> Table:
    _check((len(content) - header.body) // header.row.itemsize, header, path)
    return np.frombuffer(content, header.row, header.points, header.body)


def _compressed(content: bytes, header: _Header, path: Path) -> Table:
    """Fields one after another, all their points each, packed by LZF behind the two sizes."""
    import lzf

    body = content[header.body + 8 :]
    sizes = np.frombuffer(content[header.body : header.body + 8].ljust(8, b"\0"), "<u4")
    packed, size = int(sizes[0]), int(sizes[1])
    needed = header.points * header.row.itemsize
    if len(body) < packed or size > DENSEST * packed:
        raise PrunusError(
            f"{path}: truncated: the header promises {packed} bytes that unpack to {size}, "
            f"the file holds {len(body)}"
        )
    if size != needed:
        raise PrunusError(
            f"{path}: the bytes unpack to {size}; {header.points} points need {needed}"
        )
    held = lzf.decompress(body[:packed], size) if size else b""
    if held is None or len(held) != size:
        raise PrunusError(f"{path}: not a readable PCD file: damaged among the packed points")
    table, at = np.zeros(header.points, header.row), 0
    for name in header.row.names or ():
        kind = header.row[name]
        table[name] = np.frombuffer(held, kind, header.points, at)
        at += header.points * kind.itemsize
    return table


def _check(found: int, header: _Header, path: Path) -> None:
    if found < header.points:
        raise PrunusError(
            f"{path}: truncated: the header promises {header.points} points, the file holds {found}"
        )
