"""PLY tables as all programs write them: ASCII, little and big endian, further elements, lists.

Written here because the usual package for it (plyfile) is under the GPL, which does not suit MIT.
"""

from __future__ import annotations

import io
import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prunus.errors import PrunusError
from prunus.files.safely import BYTE_ORDER_MARK
from prunus.model.arrays import Floats

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

LONGEST_RUN = 2**20
"""Rows with lists that are looked at together, at most."""


@dataclass(frozen=True)
class _Property:
    """Its name, the type of its numbers, and for a list that of the count before them."""

    name: str
    kind: str
    count: str | None = None


@dataclass(frozen=True)
class _Element:
    name: str
    rows: int
    properties: list[_Property]

    @property
    def has_list(self) -> bool:
        return any(prop.count for prop in self.properties)


@dataclass(frozen=True, kw_only=True)
class _Header:
    form: str
    elements: list[_Element]
    comments: list[str]
    body: int


def read_ply(content: bytes, path: Path, wanted: tuple[str, ...] = ("vertex",)) -> dict[str, Table]:
    """The wanted elements as structured arrays, by name. Elements after the last one are not read.

    A list is a field of shape (k,) where all rows of its element hold k, else a field of arrays.
    Raises PrunusError on a wrong header, a truncated body, or text among the numbers.
    """
    content = content.removeprefix(BYTE_ORDER_MARK)
    header = _header(content, path)
    missing = [name for name in wanted if name not in {one.name for one in header.elements}]
    if missing:
        raise PrunusError(f"{path}: no element {missing[0]!r} in the PLY header; expected one")
    tables: dict[str, Table] = {}
    body = (
        _Lines(content, header, path) if header.form == "ascii" else _Bytes(content, header, path)
    )
    for element in header.elements:
        if set(wanted) <= set(tables):
            break
        table = body.table(element, element.name in wanted)
        if element.name in wanted:
            tables[element.name] = table
    return tables


def ply_comments(content: bytes, path: Path) -> list[str]:
    """The comments in the header of a PLY file."""
    return _header(content.removeprefix(BYTE_ORDER_MARK), path).comments


def _property(words: list[str]) -> _Property | None:
    """The property of a line of the header; None where the line is none."""
    match words:
        case ["list", count, kind, *name] if (
            name and kind in TYPES and TYPES.get(count, "f")[0] in "iu"
        ):
            return _Property(" ".join(name), TYPES[kind], TYPES[count])
        case [kind, *name] if name and kind in TYPES:
            return _Property(" ".join(name), TYPES[kind])
    return None


def _header(content: bytes, path: Path) -> _Header:
    lines = _header_lines(content, path)
    form, body, elements, comments = "", 0, list[_Element](), list[str]()
    for line, end in lines:
        match line.split():
            case ["end_header"]:
                body = end
                break
            case ["format", name, *_] if name in ORDERS:
                form = name
            case ["element", name, rows] if re.fullmatch("[0-9]{1,18}", rows):
                elements.append(_Element(name, int(rows), []))
            case ["property", *words] if elements and (found := _property(words)):
                elements[-1].properties.append(found)
            case ["comment" | "obj_info", *words]:
                comments.append(" ".join(words))
            case [] | ["ply"]:
                pass
            case _:
                raise PrunusError(f"{path}: the PLY header holds {line!r}, which means nothing")
    else:
        raise PrunusError(f"{path}: not a PLY file: expected 'ply' first and 'end_header' later")
    if not form:
        raise PrunusError(f"{path}: the PLY header names no format; expected {sorted(ORDERS)}")
    _check_names(elements, path)
    return _Header(form=form, elements=elements, comments=comments, body=body)


def _header_lines(content: bytes, path: Path) -> Iterator[tuple[str, int]]:
    """The lines of a header, which end as its first one does, and where each ends."""
    first = re.match(rb"ply[ \t]*(\r\n|\n|\r)", content)
    if first is None:
        raise PrunusError(f"{path}: not a PLY file: expected 'ply' first and 'end_header' later")
    mark, start = first[1][-1:], first.end()
    while (end := content.find(mark, start)) >= 0:
        yield content[start:end].decode("latin-1"), end + 1
        start = end + 1
    yield content[start:].decode("latin-1"), len(content)


def _check_names(elements: list[_Element], path: Path) -> None:
    groups = [[e.name for e in elements], *([p.name for p in e.properties] for e in elements)]
    double = next((n for names in groups for n in names if names.count(n) > 1), None)
    if double is not None:
        raise PrunusError(f"{path}: the PLY header names {double!r} twice; expected it once")


class _Bytes:
    """A binary body, read from its begin to its end."""

    def __init__(self, content: bytes, header: _Header, path: Path) -> None:
        self._content, self._at, self._path = content, header.body, path
        self._order = ORDERS[header.form]

    def table(self, element: _Element, wanted: bool) -> Table:
        """The next element; PrunusError where the bytes end too early."""
        if not element.has_list:
            return self._rows(element, self._dtype(element, []), element.rows, 0)
        runs, done, guess = list[Table](), 0, 1
        while done < element.rows:
            kind = self._dtype(element, self._counts(element, done))
            there = (len(self._content) - self._at) // kind.itemsize
            run = self._rows(element, kind, min(guess, element.rows - done, max(there, 1)), done)
            alike = _alike(run, element)
            self._at -= (len(run) - alike) * kind.itemsize
            guess = min(2 * guess, LONGEST_RUN) if alike == len(run) else 1
            done += alike
            if wanted:
                runs.append(run[:alike])
        return _joined(runs, element)

    def _rows(self, element: _Element, kind: np.dtype[Any], rows: int, done: int) -> Table:
        there = (len(self._content) - self._at) // max(kind.itemsize, 1)
        if there < rows and kind.itemsize:
            raise _truncated(element, done + there, self._path)
        start = self._at
        self._at += rows * kind.itemsize
        if not kind.itemsize:
            return np.zeros(0, kind)
        return np.frombuffer(self._content, kind, rows, start)

    def _counts(self, element: _Element, row: int) -> list[int]:
        """How many numbers each list of the next row holds."""
        at, counts = self._at, []
        for prop in element.properties:
            size = np.dtype(prop.kind).itemsize
            if prop.count is None:
                at += size
                continue
            head = np.dtype(self._order + prop.count)
            if at + head.itemsize > len(self._content):
                raise _truncated(element, row, self._path)
            count = int(np.frombuffer(self._content, head, 1, at)[0])
            _check_count(count, prop, self._path)
            counts.append(count)
            at += head.itemsize + count * size
            if at > len(self._content):
                raise _truncated(element, row, self._path)
        return counts

    def _dtype(self, element: _Element, counts: list[int]) -> np.dtype[Any]:
        fields, lengths = list[Any](), iter(counts)
        for prop in element.properties:
            if prop.count is None:
                fields.append((prop.name, self._order + prop.kind))
            else:
                fields.append((_count_of(prop), self._order + prop.count))
                fields.append((prop.name, self._order + prop.kind, (next(lengths),)))
        return np.dtype(fields)


def _count_of(prop: _Property) -> str:
    """The field of a list's count: a name that no property can have."""
    return f"{prop.name}\n"


def _alike(run: Table, element: _Element) -> int:
    """How many rows, from the first, have lists as long as the first row's."""
    same = np.ones(len(run), bool)
    for prop in element.properties:
        if prop.count is not None:
            counts = run[_count_of(prop)]
            same &= counts == counts[0]
    return len(run) if same.all() else int(same.argmin())


def _joined(runs: list[Table], element: _Element) -> Table:
    """The rows of all runs as one table, without the counts."""
    fields, columns = list[Any](), list[Any]()
    for prop in element.properties:
        parts = [run[prop.name] for run in runs]
        shapes = {part.shape[1:] for part in parts}
        if len(shapes) > 1:
            rows = np.empty(sum(map(len, parts)), object)
            for number, row in enumerate(row for part in parts for row in part):
                rows[number] = row
            columns.append(rows)
        else:
            columns.append(np.concatenate(parts) if parts else np.empty(0, prop.kind))
        fields.append((prop.name, columns[-1].dtype, columns[-1].shape[1:]))
    table = np.zeros(sum(map(len, runs)), fields)
    for prop, column in zip(element.properties, columns, strict=True):
        table[prop.name] = column
    return table


class _Lines:
    """An ASCII body, a line a row. Blank lines are none."""

    def __init__(self, content: bytes, header: _Header, path: Path) -> None:
        self._lines = (line for line in content[header.body :].splitlines() if line.strip())
        self._path = path

    def table(self, element: _Element, wanted: bool) -> Table:
        """The next element; PrunusError where the lines end too early."""
        lines = list(islice(self._lines, element.rows)) if element.properties else []
        if element.properties and len(lines) < element.rows:
            raise _truncated(element, len(lines), self._path)
        if element.has_list and wanted:
            return self._listed(lines, element)
        kind = np.dtype([(prop.name, _written(prop)) for prop in element.properties])
        table = np.zeros(len(lines) if wanted else 0, kind)
        if wanted and lines:
            held = io.BytesIO(b"\n".join(lines))
            values = parse_rows(held, self._path, columns=len(element.properties), remark=None)
            for column, prop in enumerate(element.properties):
                table[prop.name] = _fitting(values[:, column], prop, self._path)
        return table

    def _listed(self, lines: list[bytes], element: _Element) -> Table:
        """Rows with lists, word by word."""
        runs = list[Table]()
        for number, line in enumerate(lines, 1):
            words, fields, row = iter(line.split()), list[Any](), list[Any]()
            try:
                for prop in element.properties:
                    shape: tuple[int, ...] = ()
                    if prop.count is not None:
                        shape = (int(next(words)),)
                        _check_count(shape[0], prop, self._path)
                    read = float if prop.kind[0] == "f" else int
                    held = [read(next(words)) for _ in range(shape[0] if shape else 1)]
                    fields.append((prop.name, _written(prop), shape))
                    row.append(held if shape else held[0])
                runs.append(np.array([tuple(row)], fields))
            except (StopIteration, ValueError, OverflowError) as error:
                what = "too short" if isinstance(error, StopIteration) else str(error)
                raise PrunusError(
                    f"{self._path}: row {number} of {element.name!r}: {what}"
                ) from error
            if next(words, None) is not None:
                raise PrunusError(f"{self._path}: row {number} of {element.name!r}: too long")
        return _joined(runs, element)


def _written(prop: _Property) -> str:
    """The type of a number written as text: it may have more digits than a float holds."""
    return "<f8" if prop.kind[0] == "f" else "<" + prop.kind


def _fitting(values: Floats, prop: _Property, path: Path) -> Floats:
    """The values, which a property of that type can hold; PrunusError where it cannot."""
    if prop.kind[0] == "f":
        return values
    ends = np.iinfo(prop.kind)
    wrong = ~((values >= ends.min) & (values <= ends.max) & (values == np.floor(values)))
    if wrong.any():
        raise PrunusError(
            f"{path}: {prop.name!r} holds {values[wrong][0]:g}; "
            f"the header promises whole numbers from {ends.min} to {ends.max}"
        )
    return values


def _check_count(count: int, prop: _Property, path: Path) -> None:
    if count < 0:
        raise PrunusError(f"{path}: a list {prop.name!r} of {count} numbers; expected 0 or more")


def _truncated(element: _Element, found: int, path: Path) -> PrunusError:
    return PrunusError(
        f"{path}: truncated: the header promises {element.rows} rows of {element.name!r}, "
        f"the file holds {found}"
    )


def parse_rows(
    lines: io.BytesIO,
    path: Path,
    columns: int | None = None,
    delimiter: str | None = None,
    remark: str | None = "#",
) -> NDArray[np.float64]:
    """Rows of numbers (P, C) from text; `remark`: what begins a comment. PrunusError otherwise."""
    if lines.getbuffer()[:3] == BYTE_ORDER_MARK:
        lines = io.BytesIO(lines.getvalue()[3:])
    if not any(line.split((remark or "\n").encode())[0].strip() for line in lines):
        raise PrunusError(f"{path}: holds no points; expected rows of numbers")
    lines.seek(0)
    try:
        values = np.loadtxt(lines, np.float64, remark, delimiter, ndmin=2, encoding="latin-1")
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
