"""Points from text as people export it: names, comments and counts before the data, or none.

What can be told is read, what cannot is refused in words: never one column for another.
"""

from __future__ import annotations

import codecs
import csv
import re
from array import array
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from prunus.errors import PrunusError
from prunus.files.safely import BYTE_ORDER_MARK
from prunus.io.clouds.columns import (
    Content,
    are_axes,
    are_colours,
    axes_among,
    check_first,
    content_of,
)
from prunus.model.arrays import Bytes, Floats

REMARKS = ("#", "//", "%", "!", ";")
"""What comments begin with."""
SEPARATORS = (";", "|", "\t", ",", None)
"""What stands between columns, the surest first; None: blanks."""
COUNT = re.compile(r"[0-9]{1,18}")
NUMBER = re.compile(
    r"[+-]?(([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?|nan|inf(inity)?)", re.IGNORECASE
)
HEAD_BYTES = 2**16
"""What is looked at to see whether a file may be a cloud."""


@dataclass(frozen=True, kw_only=True)
class _Layout:
    """How the rows from line `first` on are written, and what the lines before them tell."""

    first: int
    separator: str | None
    width: int
    names: list[str] | None
    counted: bool


def read_text(content: bytes, path: Path) -> Content:
    """Points and colours from rows of text; PrunusError in words where they cannot be told."""
    lines = _decoded(content, path).split("\n")
    layout = _layout(lines, path)
    rows, commas = _rows(lines, layout, path)
    if layout.names:
        columns = dict(zip(layout.names, rows.T, strict=True))
        found = content_of(columns, layout.names, path)
    else:
        found = _unnamed(rows, path)
    if commas:
        found.notes.append("decimal commas, read as points")
    return found


def may_be_cloud(path: Path) -> bool:
    """Whether the first part of a text file holds a row of three numbers, or names of x, y, z.

    A note or a table of something else does not; what is empty or cannot be read may.
    """
    try:
        with path.open("rb") as file:
            lines = _decoded(file.read(HEAD_BYTES), path).split("\n")
    except (OSError, PrunusError):
        return True
    bare = [line.strip() for line in lines]
    return not any(bare) or any(_separator_of(line, 3)[1] or _named_in(line, None) for line in bare)


def _decoded(content: bytes, path: Path) -> str:
    """The text, its lines ended by newlines, whatever byte order mark and line ends it has."""
    coding = "latin-1"
    if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        coding = "utf-16"
    elif content.startswith(BYTE_ORDER_MARK):
        coding = "utf-8-sig"
    elif b"\0" in content:
        raise PrunusError(f"{path}: holds bytes that are no text; expected rows of numbers")
    return content.decode(coding, "replace").replace("\r\n", "\n").replace("\r", "\n")


def _layout(lines: list[str], path: Path) -> _Layout:
    """What the lines before the first row of numbers tell."""
    heads, counted = list[tuple[str, bool]](), False
    for number, line in enumerate(map(str.strip, lines)):
        if not line.strip(" \t;,|"):
            continue
        if COUNT.fullmatch(line):
            counted = True
        elif line.startswith((*REMARKS, "sep=", "SEP=")) or _numbers_columns(lines, number):
            heads.append((line.lstrip("#/%;! \t"), True))
        else:
            named = any(_named_in(head, None) for head, _ in heads)
            separator, words = _separator_of(line, 0 if named else 3)
            if words:
                cells = len(_cells(line, separator))
                full = any(_named_in(head, cells) for head, _ in heads)
                width = cells if full else len(words)
                names = _names(heads, separator, width, path)
                return _Layout(
                    first=number, separator=separator, width=width, names=names, counted=counted
                )
            heads.append((line, False))
    odd = next((line for line, remark in heads if not remark), None)
    if odd is not None:
        _refuse(odd, path)
    raise PrunusError(f"{path}: holds no points; expected rows of numbers")


def _numbers_columns(lines: list[str], number: int) -> bool:
    """Whether a line holds 0, 1, 2, ... and the next one fractions: pandas' names of no names."""
    words = _separator_of(lines[number].strip(), 3)[1]
    places = [str(place) for place in range(len(words))]
    following = next((line for line in lines[number + 1 :] if line.strip()), "")
    return bool(words) and words in (places, ["", *places[:-1]]) and "." in following


def _refuse(line: str, path: Path) -> None:
    """Say what is wrong with a line that is neither row nor names nor comment."""
    words = _words(line, next((s for s in SEPARATORS if s and s in line), None))
    found = sum(NUMBER.fullmatch(word) is not None for word in words)
    if found == len(words):
        raise PrunusError(f"{path}: rows hold {found} numbers; expected x, y, z")
    if not found and len(words) > 1:
        axes_among(words, path)
    raise PrunusError(
        f"{path}: {line[:60]!r} is neither a row of numbers, nor names of columns, nor a comment"
    )


def _separator_of(line: str, first: int) -> tuple[str | None, list[str]]:
    """What stands between the columns of a row, and its words; no words where it is no row.

    A row holds three numbers, and begins with as many as `first` says.
    """
    for separator in SEPARATORS:
        if separator and line.count(separator) < 2:
            continue
        words = [word.replace(",", ".") for word in _words(line, separator)]
        numbers = [not word or NUMBER.fullmatch(word) is not None for word in words]
        if sum(numbers) >= 3 and any(words) and all(numbers[:first]):
            return separator, words
    return None, []


def _cells(line: str, separator: str | None) -> list[str]:
    """What stands between the separators of a line; one within quotes is part of a word."""
    if '"' not in line:
        return [word.strip() for word in line.split(separator)]
    held = line if separator else " ".join(line.split())
    row = next(csv.reader([held], delimiter=separator or " ", skipinitialspace=True), [])
    return [word.strip() for word in row]


def _words(line: str, separator: str | None) -> list[str]:
    """The words of a line, without nothing behind separators at its end."""
    words = _cells(line, separator)
    while words and not words[-1]:
        words.pop()
    return words


def _named_in(line: str, width: int | None) -> list[str]:
    """The names of x, y, z and others that a line holds, of so many columns; none otherwise."""
    line = re.sub(r"\s+(?=[\[(])", "", line.lstrip("#/%;! \t"))
    for separator in SEPARATORS:
        names = _words(line, separator)
        names = names[1:] if names and names[0].endswith(":") else names
        numbers = any(NUMBER.fullmatch(name) for name in names)
        if are_axes(names) and not numbers and width in (None, len(names)):
            return names
    return []


def _names(
    heads: list[tuple[str, bool]], separator: str | None, width: int, path: Path
) -> list[str] | None:
    """The names of the columns, if the lines before the data give any.

    Those next to the data count. A line that is no comment must be names; a comment may be prose.
    """
    for line, remark in reversed(heads):
        if names := _named_in(line, width):
            return names
        names = _named_in(line, None)
        if not names and not remark:
            _refuse(line, path)
        if names and not (remark and _in_order(names, width)):
            raise PrunusError(
                f"{path}: {len(names)} names ({', '.join(names)}), but rows of {width} columns; "
                "expected a name a column"
            )
    return None


def _in_order(names: list[str], width: int) -> bool:
    """Whether names that are not one a column say what is taken anyway: x, y, z come first."""
    axes = axes_among(names, "")
    return axes == [0, 1, 2] or (width == 3 and axes == sorted(axes))


def _rows(lines: list[str], layout: _Layout, path: Path) -> tuple[Floats, bool]:
    """The rows as numbers (P, C), NaN where words stand; and whether their decimals are commas."""
    body = _without_remarks("\n".join(lines[layout.first :]), layout.separator)
    commas = layout.separator != "," and "," in body and bool(re.search("[0-9],[0-9]", body))
    if commas and re.search("[0-9][.][0-9]", body) is None:
        body = body.replace(",", ".")
    if layout.separator == "," and not layout.names:
        _check_decimals(body, path)
    promised = None
    if layout.counted:
        counts = re.compile(r"^[ \t]*([0-9]{1,18})[ \t]*$", re.MULTILINE)
        told = counts.findall("\n".join(lines[: layout.first])) + counts.findall(body)
        promised, body = sum(map(int, told)), counts.sub("", body)
    rows = body.split("\n")
    try:
        values = np.loadtxt(rows, np.float64, None, layout.separator, ndmin=2)
    except ValueError:
        values = _word_by_word(rows, layout, path)
    if promised is not None and promised != len(values):
        cut = "truncated: " if promised > len(values) else ""
        raise PrunusError(
            f"{path}: {cut}the counts among the rows promise {promised} points, "
            f"the file holds {len(values)}"
        )
    return values, commas


def _without_remarks(body: str, separator: str | None) -> str:
    """The rows without comments."""
    marks = [re.escape(mark) for mark in REMARKS if mark in body and mark != separator]
    if not marks:
        return body
    return re.sub(rf"(^|[ \t])[ \t]*({'|'.join(marks)}).*$", "", body, flags=re.MULTILINE)


def _check_decimals(body: str, path: Path) -> None:
    """That commas stand only between numbers: without any point, pairs of columns may be one."""
    first = body.partition("\n")[0]
    if "." not in body and first.count(",") >= 5 and first.count(",") % 2:
        raise PrunusError(
            f"{path}: {first[:60]!r} may have commas within numbers, or between them; expected "
            "decimal points, another separator, or the names of the columns in the first line"
        )


def _word_by_word(rows: list[str], layout: _Layout, path: Path) -> Floats:
    """Rows among whose columns are words or nothing, which are NaN.

    PrunusError, naming the line, where x, y or z is a word, or a row is longer or shorter.
    """
    needed = axes_among(layout.names, path) if layout.names else [0, 1, 2]
    held = array("d")
    for number, line in enumerate(rows, layout.first + 1):
        cells = _cells(line, layout.separator)
        if not any(cells):
            continue
        if len(cells) < layout.width or any(cells[layout.width :]):
            raise PrunusError(
                f"{path}: the number of columns changed: line {number} holds {len(cells)}, "
                f"line {layout.first + 1} {layout.width}; expected rows alike"
            )
        for column, word in enumerate(cells[: layout.width]):
            there = NUMBER.fullmatch(word)
            if word and not there and column in needed:
                raise PrunusError(f"{path}: line {number}: {word[:40]!r} is no number")
            held.append(float(word) if there else np.nan)
    return np.frombuffer(held, np.float64).reshape(-1, layout.width)


def _unnamed(rows: Floats, path: Path) -> Content:
    """x, y, z first, by convention; colours behind them where they are plausibly that."""
    width = rows.shape[1]
    if width == 3:
        return Content(xyz=rows.copy())
    check_first(rows, path)
    rgb, where = _colours(rows, path)
    note = f"{width} columns without names: 1 to 3 are read as x, y, z{where}"
    return Content(xyz=rows[:, :3].copy(), rgb=rgb, notes=[note])


def _colours(rows: Floats, path: Path) -> tuple[Bytes | None, str]:
    """The colours behind unnamed x, y, z, and where they stand in words.

    Columns 4 to 6 of six; of seven those, or behind an intensity 5 to 7, as PTS has it.
    """
    width = rows.shape[1]
    places = {6: [3], 7: [4] if path.suffix.lower() == ".pts" else [3, 4]}.get(width, [])
    found = [at for at in places if are_colours(rows[:, at : at + 3])]
    if len(found) != 1:
        return None, ""
    at = found[0]
    return rows[:, at : at + 3].astype(np.uint8), f", {at + 1} to {at + 3} as red, green, blue"
