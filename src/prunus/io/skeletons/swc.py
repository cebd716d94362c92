"""SWC, the table of neuron tools: a row a node, `id type x y z radius parent`.

Ours has the labels as types. Those of others come with further columns (ESWC), with commas or tabs,
with a line of names, in any order, with several roots: `read_rows` reads them all.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from prunus.errors import PrunusError
from prunus.files.reading import lines_of, read_text, short
from prunus.files.safely import write_bytes
from prunus.model import Floats, Ints, Label, Skeleton

TYPES = {Label.TRUNK: 16, Label.SUPPORT: 17, Label.LEADER: 18, Label.SIDE_BRANCH: 19}
"""SWC structure identifiers; those over 15 are free for such use."""

COLUMNS = ("id", "type", "x", "y", "z", "radius", "parent")
ALIASES = {
    "n": "id", "node_id": "id", "sample": "id", "index": "id", "pointno": "id", "label": "type",
    "t": "type", "structure": "type", "r": "radius", "p": "parent", "pid": "parent",
    "parent_id": "parent", "parentid": "parent",
}  # fmt: skip
"""How others call the columns, where a file names them."""

NUMBER = re.compile(
    r"[+-]?(?:(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:e[+-]?[0-9]+)?|nan|inf(?:inity)?)", re.I
)
WHOLE = 2**53
"""Whole numbers up to here are what they seem to be when a program wrote them as floats."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Rows:
    """The rows (M,) of a file, in its order: `parent` is the row of the parent, -1 at a root.

    type: whole numbers of any size; xyz (M, 3) and radius (M,) as the file has them.
    """

    type: list[int]
    xyz: Floats
    radius: Floats
    parent: Ints


def write_swc(path: str | Path, skeleton: Skeleton) -> None:
    """A row a node: id, type, x, y, z, radius, parent. An unknown radius is written as 0."""
    types = ", ".join(f"{code} = {label.word}" for label, code in TYPES.items())
    lines = [
        "# prunus skeleton; unit: metre; frame: that of the input file",
        f"# types: {types}; radius 0 = unknown",
        "# id type x y z radius parent",
    ]
    radius = np.nan_to_num(skeleton.radius, nan=0.0)
    for row in range(len(skeleton)):
        x, y, z = skeleton.xyz[row].tolist()
        parent = int(skeleton.parent[row])
        code = TYPES[Label(skeleton.label[row])]
        above = parent + 1 if parent >= 0 else -1
        lines.append(f"{row + 1} {code} {x!r} {y!r} {z!r} {float(radius[row])!r} {above}")
    write_bytes(Path(path), ("\n".join(lines) + "\n").encode())


def read_swc(path: str | Path) -> Skeleton:
    """A skeleton from SWC rows in any order; PrunusError on several roots, loops, unknown types."""
    path = Path(path)
    rows = read_rows(path)
    label_of = {code: label for label, code in TYPES.items()}
    unknown = [code for code in rows.type if code not in label_of]
    if unknown:
        raise PrunusError(
            f"{path}: type {short(min(unknown))} is no label; "
            f"expected {sorted(label_of)} as prunus writes"
        )
    roots = int((rows.parent < 0).sum())
    if roots != 1:
        raise PrunusError(f"{path}: {roots} rows without a parent; expected one base")
    if (rows.radius < 0).any() or np.isinf(rows.radius).any():
        raise PrunusError(
            f"{path}: radius {np.nanmin(rows.radius):g}; expected 0 (unknown) or more"
        )
    order = _parents_first(rows.parent)
    row_of = np.empty(len(order), np.int64)
    row_of[order] = np.arange(len(order))
    parent = np.where(rows.parent[order] < 0, -1, row_of[rows.parent[order]])
    radius = np.where(rows.radius[order] == 0, np.nan, rows.radius[order])
    labels = [label_of[rows.type[row]] for row in order]
    return Skeleton.build(rows.xyz[order], parent, labels, radius=radius)


def read_rows(path: Path) -> Rows:
    """The rows of any SWC; PrunusError naming file and line where they are no trees."""
    ids, types, values, above, lines = [], [], [], [], []
    for line, words in _table(read_text(path, lenient=True), path):
        where = f"{path}: line {line}"
        ids.append(_whole(words[0], where))
        types.append(_whole(words[1], where))
        values.append([_number(word, where) for word in words[2:6]])
        above.append(_whole(words[6], where))
        lines.append(line)
    if not ids:
        raise PrunusError(f"{path}: no rows; expected {' '.join(COLUMNS)}")
    table = np.array(values)
    lost = ~np.isfinite(table[:, :3]).all(axis=1)
    if lost.any():
        line = lines[int(lost.argmax())]
        raise PrunusError(f"{path}: line {line}: x, y or z is NaN or infinite; expected metres")
    parent = _parents(ids, above, lines, path)
    return Rows(type=types, xyz=table[:, :3], radius=table[:, 3], parent=parent)


def _parents(ids: list[int], above: list[int], lines: list[int], path: Path) -> Ints:
    """The row of each row's parent, -1 for none; PrunusError where that is no forest."""
    row_of: dict[int, int] = {}
    for row, number in enumerate(ids):
        if row_of.setdefault(number, row) != row:
            raise PrunusError(
                f"{path}: line {lines[row]}: the id {short(number)} stands twice; "
                "expected each once"
            )
    parent = np.full(len(ids), -1)
    for row, number in enumerate(above):
        if number < 0:
            continue
        if number not in row_of or number == ids[row]:
            found = "itself" if number == ids[row] else "no row"
            raise PrunusError(
                f"{path}: line {lines[row]}: parent {short(number)} is {found}; "
                "expected the id of another row, or -1"
            )
        parent[row] = row_of[number]
    looped = set(range(len(ids))) - set(_parents_first(parent))
    if looped:
        raise PrunusError(
            f"{path}: {len(looped)} rows hang on no root, the first in line "
            f"{lines[min(looped)]}: their parents go round in a loop"
        )
    return parent


def _parents_first(parent: Ints) -> list[int]:
    """The rows that hang on a root, each after its parent; in file order, where that is one."""
    if (parent < np.arange(len(parent))).all():
        return list(range(len(parent)))
    below: dict[int, list[int]] = {}
    for row, above in enumerate(parent.tolist()):
        below.setdefault(above, []).append(row)
    reached = list(below.get(-1, []))
    for row in reached:
        reached += below.get(row, [])
    return reached


def _table(text: str, path: Path) -> Iterator[tuple[int, list[str]]]:
    """The number of each line that is a row, and its seven words, in the order of `COLUMNS`."""
    order: list[int] | None = None
    for line, whole in enumerate(lines_of(text), 1):
        content = whole.split("#", 1)[0].strip()
        if not content:
            continue
        mark = next((mark for mark in ";," if mark in content), None)
        words = [word.strip(' \t"') for word in content.split(mark)]
        if order is None:
            named = not NUMBER.fullmatch(words[0])
            order = _order(words, f"{path}: line {line}") if named else list(range(len(COLUMNS)))
            if named:
                continue
        if len(words) <= max(order):
            raise PrunusError(
                f"{path}: line {line}: {len(words)} columns; expected {' '.join(COLUMNS)}"
            )
        yield line, [words[column] for column in order]


def _order(words: list[str], where: str) -> list[int]:
    """Where the columns stand in a file that names them."""
    names = [ALIASES.get(word.lower(), word.lower()) for word in words]
    if any(names.count(column) != 1 for column in COLUMNS):
        raise PrunusError(f"{where}: {short(' '.join(words))}; expected {' '.join(COLUMNS)}")
    return [names.index(column) for column in COLUMNS]


def _number(word: str, where: str) -> float:
    if not NUMBER.fullmatch(word):
        raise PrunusError(f"{where}: {short(word)} is no number")
    return float(word)


def _whole(word: str, where: str) -> int:
    """A whole number, which some programs write as 3.0."""
    if re.fullmatch("[+-]?[0-9]{1,4000}", word):
        return int(word)
    value = _number(word, where)
    if not abs(value) <= WHOLE or value != int(value):
        raise PrunusError(f"{where}: {short(word)} is no whole number")
    return int(value)
