"""Skeletons of any tool as plain lines: points and edges, without labels or direction.

PLY with edges, SWC, OBJ lines, GraphML with x, y, z; prunus's own files too.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from prunus.errors import PrunusError
from prunus.io.ply import read_ply
from prunus.io.safely import read_bytes
from prunus.io.skeletons import read_record
from prunus.io.swc import read_rows
from prunus.model import Floats, Ints, Lines


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
        raise PrunusError(f"{path}: an edge to node {edges.max()}; expected 0 to {len(xyz) - 1}")
    return Lines(xyz, edges)


def _from_json(path: Path) -> tuple[Floats, Ints]:
    skeleton, _ = read_record(path)
    return skeleton.xyz, skeleton.edges


def _from_swc(path: Path) -> tuple[Floats, Ints]:
    """Any SWC: types, several roots and any order are fine."""
    rows = read_rows(path)
    hung = np.flatnonzero(rows.parent >= 0)
    return rows.xyz, np.column_stack([rows.parent[hung], hung])


def _from_ply(path: Path) -> tuple[Floats, Ints]:
    tables = read_ply(read_bytes(path), path, ("vertex", "edge"))
    vertex, edge = tables["vertex"], tables["edge"]
    try:
        xyz = np.column_stack([vertex[axis].astype(np.float64) for axis in "xyz"])
        ends = [edge[name].astype(np.int64) for name in ("vertex1", "vertex2")]
    except ValueError as error:
        raise PrunusError(f"{path}: {error}; expected x, y, z and vertex1, vertex2") from error
    return xyz, np.column_stack(ends)


def _from_obj(path: Path) -> tuple[Floats, Ints]:
    """Vertices `v` and polylines `l` of a Wavefront OBJ; a negative number counts from the end."""
    points: list[list[float]] = []
    edges: list[tuple[int, int]] = []
    text = read_bytes(path).decode("utf-8", "replace")
    for number, line in enumerate(text.splitlines(), 1):
        words = line.split()
        try:
            if words[:1] == ["v"]:
                points.append([float(word) for word in words[1:4]])
            elif words[:1] == ["l"]:
                at = [int(word.split("/")[0]) for word in words[1:]]
                rows = [k - 1 if k > 0 else len(points) + k for k in at]
                edges += list(pairwise(rows))
        except ValueError as error:
            raise PrunusError(f"{path}: line {number}: {error}") from error
    xyz = np.array(points, np.float64).reshape(len(points), -1)
    if xyz.shape[1:] != (3,):
        raise PrunusError(f"{path}: no vertices of three numbers; expected lines `v x y z`")
    return xyz, np.array(edges, np.int64).reshape(-1, 2)


def _from_graphml(path: Path) -> tuple[Floats, Ints]:
    """GraphML whose nodes carry x, y, z."""
    try:
        root = ElementTree.fromstring(read_bytes(path))
    except ElementTree.ParseError as error:
        raise PrunusError(f"{path}: not XML ({error}); expected GraphML") from error
    name_of = {key.get("id"): key.get("attr.name") for key in _all(root, "key")}
    row_of: dict[str | None, int] = {}
    points = []
    for node in _all(root, "node"):
        held = {name_of.get(d.get("key")): d.text for d in _all(node, "data")}
        try:
            points.append([float(held[axis] or "") for axis in "xyz"])
        except (KeyError, ValueError) as error:
            raise PrunusError(f"{path}: node {node.get('id')!r} without x, y, z") from error
        row_of[node.get("id")] = len(row_of)
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
