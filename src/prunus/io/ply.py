"""PLY tables: ASCII, little and big endian, any numeric properties.

Written here because the usual package for it (plyfile) is under the GPL, which does not suit MIT.
"""

from __future__ import annotations

import io
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prunus.errors import PrunusError

Table = NDArray[Any]
"""A structured array: one named field a property."""

TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1",
    "short": "i2", "int16": "i2", "ushort": "u2", "uint16": "u2",
    "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4",
    "float": "f4", "float32": "f4", "double": "f8", "float64": "f8",
}  # fmt: skip
NAMES = {np.dtype(code): name for name, code in reversed(TYPES.items())}
ORDERS = {"ascii": "<", "binary_little_endian": "<", "binary_big_endian": ">"}


@dataclass
class _Element:
    name: str
    rows: int
    fields: list[tuple[str, str]]
    has_list: bool = False


def read_ply(content: bytes, path: Path, wanted: tuple[str, ...] = ("vertex",)) -> dict[str, Table]:
    """The wanted elements as structured arrays, by name. Elements after the last one are not read.

    Raises PrunusError on a wrong header, a truncated body, or text among the numbers.
    """
    form, elements, body = _header(content, path)
    tables: dict[str, Table] = {}
    lines = iter(content[body:].splitlines()) if form == "ascii" else iter(())
    for element in elements:
        if set(wanted) <= set(tables):
            break
        if element.has_list:
            raise PrunusError(
                f"{path}: the element {element.name!r} holds a list; "
                f"expected plain numbers up to the element {wanted[-1]!r}"
            )
        dtype = np.dtype([(name, ORDERS[form] + code) for name, code in element.fields])
        if form == "ascii":
            table = _ascii(lines, dtype, element, path)
        else:
            table = _binary(content, body, dtype, element, path)
            body += table.nbytes
        if element.name in wanted:
            tables[element.name] = table
    missing = [name for name in wanted if name not in tables]
    if missing:
        raise PrunusError(f"{path}: no element {missing[0]!r} in the PLY header; expected one")
    return tables


def _header(content: bytes, path: Path) -> tuple[str, list[_Element], int]:
    end = content.find(b"end_header")
    if not content.startswith(b"ply") or end < 0:
        raise PrunusError(f"{path}: not a PLY file: expected 'ply' first and 'end_header' later")
    form, elements = "", []
    for line in content[:end].decode("latin-1").splitlines()[1:]:
        match line.split():
            case ["format", name, _] if name in ORDERS:
                form = name
            case ["element", name, rows] if rows.isdigit():
                elements.append(_Element(name, int(rows), []))
            case ["property", "list", *_] if elements:
                elements[-1].has_list = True
            case ["property", kind, name] if elements and kind in TYPES:
                elements[-1].fields.append((name, TYPES[kind]))
            case [] | ["comment" | "obj_info", *_]:
                pass
            case _:
                raise PrunusError(f"{path}: the PLY header holds {line!r}, which means nothing")
    if not form:
        raise PrunusError(f"{path}: the PLY header names no format; expected {sorted(ORDERS)}")
    return form, elements, content.index(b"\n", end) + 1 if b"\n" in content[end:] else len(content)


def _binary(
    content: bytes, start: int, dtype: np.dtype[Any], element: _Element, path: Path
) -> Table:
    found = (len(content) - start) // max(dtype.itemsize, 1)
    if found < element.rows:
        raise PrunusError(
            f"{path}: truncated: the header promises {element.rows} rows of {element.name!r}, "
            f"the file holds {found}"
        )
    return np.frombuffer(content, dtype, element.rows, start)


def _ascii(lines: Any, dtype: np.dtype[Any], element: _Element, path: Path) -> Table:
    rows = [line for line, _ in zip(lines, range(element.rows), strict=False)]
    if len(rows) < element.rows:
        raise PrunusError(
            f"{path}: truncated: the header promises {element.rows} rows of {element.name!r}, "
            f"the file holds {len(rows)}"
        )
    table = np.zeros(element.rows, dtype)
    if element.rows:
        values = parse_rows(io.BytesIO(b"\n".join(rows)), path, columns=len(element.fields))
        for column, (name, _) in enumerate(element.fields):
            table[name] = values[:, column]
    return table


def parse_rows(
    lines: io.BytesIO, path: Path, columns: int | None = None, delimiter: str | None = None
) -> NDArray[np.float64]:
    """Rows of numbers (P, C) from text; PrunusError naming the row otherwise."""
    if not any(line.split(b"#")[0].strip() for line in lines):
        raise PrunusError(f"{path}: holds no points; expected rows of numbers")
    lines.seek(0)
    try:
        values = np.loadtxt(lines, np.float64, delimiter=delimiter, ndmin=2, encoding="latin-1")
    except (ValueError, OverflowError) as error:
        raise PrunusError(f"{path}: {error}; expected rows of numbers") from error
    if columns is not None and values.shape[1] != columns:
        raise PrunusError(f"{path}: rows hold {values.shape[1]} numbers; expected {columns}")
    return values


def ply_bytes(elements: dict[str, Table], comments: list[str]) -> bytes:
    """A binary little endian PLY file of these tables."""
    header = ["ply", "format binary_little_endian 1.0", *(f"comment {text}" for text in comments)]
    body = b""
    for name, table in elements.items():
        header.append(f"element {name} {len(table)}")
        fields = table.dtype.names or ()
        header += [f"property {NAMES[table.dtype[field]]} {field}" for field in fields]
        body += table.astype(table.dtype.newbyteorder("<")).tobytes()
    return "\n".join([*header, "end_header", ""]).encode("ascii", "replace") + body


def table_of(columns: dict[str, NDArray[Any]]) -> Table:
    """A structured array of these columns."""
    rows = len(next(iter(columns.values())))
    table = np.zeros(rows, [(name, values.dtype) for name, values in columns.items()])
    for name, values in columns.items():
        table[name] = values
    return table
