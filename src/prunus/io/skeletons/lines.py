"""Skeletons of any tool as plain lines: points and edges, without labels or direction.

PLY with edges, SWC, OBJ lines, GraphML with x, y, z; prunus's own files too.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from prunus.errors import PrunusError
from prunus.files.reading import lines_of, read_bytes, read_text, short
from prunus.io.ply import Table, read_ply
from prunus.io.skeletons.skeleton_file import read_record
from prunus.io.skeletons.swc import read_rows
from prunus.model import Floats, Ints, Lines

MANY = 2**40
"""No file that fits a memory has so many vertices."""
LONGEST_M = 1e5
"""No tree has so many metres of wood: what is longer is in millimetres, or damaged."""


def read_lines(path: str | Path) -> Lines:
    """The lines of a skeleton file, by its ending; PrunusError naming the file otherwise."""
    path = Path(path)
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise PrunusError(
            f"{path}: {path.suffix!r} is no skeleton; expected one of {' '.join(sorted(READERS))}"
        )
    xyz, edges = reader(path)
    if len(edges) == 0:
        raise PrunusError(f"{path}: no edges; expected a skeleton of nodes and edges")
    if not np.isfinite(xyz).all():
        raise PrunusError(f"{path}: NaN or infinity among the nodes; expected finite metres")
    if edges.min() < 0 or edges.max() >= len(xyz):
        wrong = edges.min() if edges.min() < 0 else edges.max()
        raise PrunusError(f"{path}: an edge to node {wrong}; expected 0 to {len(xyz) - 1}")
    return checked_length(Lines(xyz, edges), path)


def checked_length(lines: Lines, path: Path) -> Lines:
    """The same lines; PrunusError where they are longer than those of any tree."""
    with np.errstate(over="ignore"):
        whole = float(np.linalg.norm(np.diff(lines.xyz[lines.edges], axis=1), axis=2).sum())
    if not whole <= LONGEST_M:
        raise PrunusError(f"{path}: {whole:.3g} units of lines; expected a tree in metres")
    return lines


def _from_json(path: Path) -> tuple[Floats, Ints]:
    skeleton, _ = read_record(path)
    return skeleton.xyz, skeleton.edges


def _from_swc(path: Path) -> tuple[Floats, Ints]:
    """Any SWC: types, several roots and any order are fine."""
    rows = read_rows(path)
    hung = np.flatnonzero(rows.parent >= 0)
    return rows.xyz, np.column_stack([rows.parent[hung], hung])


def _from_ply(path: Path) -> tuple[Floats, Ints]:
    """Edges as an element of their own (MeshLab, Blender, Open3D, AdTree), or faces of two."""
    content = read_bytes(path)
    header = content[: content.find(b"end_header")]
    name = "edge" if re.search(rb"^element[ \t]+edge\b", header, re.MULTILINE) else "face"
    tables = read_ply(content, path, ("vertex", name))
    try:
        xyz = np.column_stack([tables["vertex"][axis].astype(np.float64) for axis in "xyz"])
        return xyz, _ends(tables[name])
    except ValueError as error:
        raise PrunusError(
            f"{path}: {error}; expected x, y, z, and vertex1 and vertex2 or lists of two vertices"
        ) from error


def _ends(table: Table) -> Ints:
    """The vertices (E, 2) of each edge; ValueError where they are not two, or no whole numbers."""
    names = table.dtype.names or ()
    if {"vertex1", "vertex2"} <= set(names):
        ends = np.column_stack([table["vertex1"], table["vertex2"]])
    else:
        listed = [name for name in names if name in ("vertex_indices", "vertex_index")]
        if not listed:
            raise ValueError(f"the edges hold {', '.join(names) or 'nothing'}")
        ends = table[listed[0]]
    if len(ends) == 0:
        return np.empty((0, 2), np.int64)
    if ends.ndim != 2 or ends.shape[1] != 2:
        raise ValueError("edges of more or less than two vertices")
    if ends.dtype.kind == "f" and not (np.isfinite(ends) & (ends == np.round(ends))).all():
        raise ValueError("a vertex that is no whole number")
    return np.asarray(ends, np.int64)


def _from_obj(path: Path) -> tuple[Floats, Ints]:
    """Vertices `v` and polylines `l` of a Wavefront OBJ; a negative number counts from the end."""
    points: list[list[float]] = []
    edges: list[tuple[int, int]] = []
    for number, words in _statements(read_text(path, lenient=True)):
        try:
            if words[0] == "v":
                points.append(_place(words[1:4]))
            elif words[0] == "l":
                edges += pairwise(_vertex(word, len(points)) for word in words[1:])
        except ValueError as error:
            raise PrunusError(f"{path}: line {number}: {error}") from error
    return np.array(points).reshape(-1, 3), np.array(edges, np.int64).reshape(-1, 2)


def _statements(text: str) -> Iterator[tuple[int, list[str]]]:
    """The words of each statement, which a backslash takes on to the next line; and its line."""
    whole = ""
    for number, line in enumerate(lines_of(text), 1):
        content = whole + line.split("#", 1)[0].strip()
        whole = f"{content[:-1]} " if content.endswith("\\") else ""
        if content.split() and not whole:
            yield number, content.split()


def _place(words: list[str]) -> list[float]:
    if len(words) != 3:
        raise ValueError(f"{len(words)} numbers; expected `v x y z`")
    return [float(word) for word in words]


def _vertex(word: str, count: int) -> int:
    """The row of a vertex as `l` names it, `count` of which stand before; ValueError for none."""
    number = int(word.split("/")[0])
    row = number - 1 if number > 0 else count + number
    if number == 0 or not 0 <= row < MANY:
        raise ValueError(f"vertex {short(number)}; expected 1 or more, or -1 to -{count}")
    return row


def _from_graphml(path: Path) -> tuple[Floats, Ints]:
    """GraphML whose nodes carry x, y, z."""
    try:
        root = ElementTree.fromstring(read_bytes(path))
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise PrunusError(f"{path}: not XML ({error}); expected GraphML") from error
    keys = {key.get("id"): key for key in _all(root, "key")}
    usual = {
        key.get("attr.name"): child.text for key in keys.values() for child in _all(key, "default")
    }
    row_of: dict[str | None, int] = {}
    points = []
    for node in _all(root, "node"):
        told = [(keys.get(data.get("key")), data.text) for data in _all(node, "data")]
        held = usual | {key.get("attr.name"): text for key, text in told if key is not None}
        try:
            points.append([float(held[axis] or "") for axis in "xyz"])
        except (KeyError, ValueError) as error:
            raise PrunusError(f"{path}: node {node.get('id')!r} without x, y, z") from error
        if row_of.setdefault(node.get("id"), len(row_of)) != len(points) - 1:
            raise PrunusError(f"{path}: node {node.get('id')!r} stands twice; expected it once")
    try:
        edges = [(row_of[e.get("source")], row_of[e.get("target")]) for e in _all(root, "edge")]
    except KeyError as error:
        raise PrunusError(f"{path}: an edge to {error}, which is no node") from error
    return np.array(points, np.float64).reshape(-1, 3), np.array(edges, np.int64).reshape(-1, 2)


def _all(element: Any, name: str) -> list[Any]:
    """All elements of a name, whatever their namespace."""
    return [child for child in element.iter() if str(child.tag).rsplit("}", 1)[-1] == name]


READERS: dict[str, Callable[[Path], tuple[Floats, Ints]]] = {
    ".json": _from_json,
    ".swc": _from_swc,
    ".eswc": _from_swc,
    ".ply": _from_ply,
    ".obj": _from_obj,
    ".graphml": _from_graphml,
}
"""By the ending of the file."""
