"""Skeletons for other tools: SWC tables, coloured PLY edges, GraphML."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np

from prunus.errors import PrunusError
from prunus.io.ply import parse_rows, ply_bytes, table_of
from prunus.io.safely import read_bytes, write_bytes
from prunus.model import Floats, Ints, Label, Skeleton

COLOURS = {
    Label.TRUNK: (0, 0, 0),
    Label.SUPPORT: (213, 94, 0),
    Label.LEADER: (0, 114, 178),
    Label.SIDE_BRANCH: (0, 158, 115),
}
"""Red, green, blue of each label: Okabe and Ito's palette, which colour-blind people tell apart."""

SWC_TYPES = {Label.TRUNK: 16, Label.SUPPORT: 17, Label.LEADER: 18, Label.SIDE_BRANCH: 19}
"""SWC structure identifiers; those over 15 are free for such use."""


def write_swc(path: str | Path, skeleton: Skeleton) -> None:
    """A row a node: id, type, x, y, z, radius, parent. An unknown radius is written as 0."""
    types = ", ".join(f"{code} = {label.word}" for label, code in SWC_TYPES.items())
    lines = [
        "# prunus skeleton; unit: metre; frame: that of the input file",
        f"# types: {types}; radius 0 = unknown",
        "# id type x y z radius parent",
    ]
    radius = np.nan_to_num(skeleton.radius, nan=0.0)
    for row in range(len(skeleton)):
        x, y, z = skeleton.xyz[row].tolist()
        parent = int(skeleton.parent[row])
        code = SWC_TYPES[Label(skeleton.label[row])]
        above = parent + 1 if parent >= 0 else -1
        lines.append(f"{row + 1} {code} {x!r} {y!r} {z!r} {float(radius[row])!r} {above}")
    write_bytes(Path(path), ("\n".join(lines) + "\n").encode())


def read_swc(path: str | Path) -> Skeleton:
    """A skeleton from SWC rows in any order; PrunusError on several roots, loops, unknown types."""
    path = Path(path)
    values = parse_rows(io.BytesIO(read_bytes(path)), path, columns=7)
    ids, above = values[:, 0].astype(np.int64), values[:, 6].astype(np.int64)
    label_of = {code: label for label, code in SWC_TYPES.items()}
    codes = values[:, 1].astype(np.int64)
    unknown = set(codes.tolist()) - set(label_of)
    if unknown:
        raise PrunusError(
            f"{path}: type {min(unknown)} is no label; expected {sorted(label_of)} as prunus writes"
        )
    order = _parents_first(ids, above, path)
    row_of = {int(ids[row]): new for new, row in enumerate(order)}
    parent = [-1, *(row_of[int(above[row])] for row in order[1:])]
    radius = np.where(values[order, 5] == 0, np.nan, values[order, 5])
    labels = [label_of[int(codes[row])] for row in order]
    try:
        return Skeleton.build(values[order, 2:5], parent, labels, radius=radius)
    except ValueError as error:
        raise PrunusError(f"{path}: {error}") from error


def _parents_first(ids: Ints, above: Ints, path: Path) -> list[int]:
    """The rows, each after its parent; file order otherwise."""
    if len(np.unique(ids)) < len(ids):
        raise PrunusError(f"{path}: an id stands twice; expected each once")
    below: dict[int, list[int]] = {}
    for row, parent in enumerate(above.tolist()):
        below.setdefault(parent, []).append(row)
    roots = below.get(-1, [])
    if len(roots) != 1:
        raise PrunusError(f"{path}: {len(roots)} rows without a parent; expected one base")
    reached = list(roots)
    for row in reached:
        reached += below.get(int(ids[row]), [])
    if len(reached) < len(ids):
        raise PrunusError(
            f"{path}: {len(ids) - len(reached)} rows do not hang on the base; expected one tree"
        )
    return sorted(reached) if (above < ids).all() and (np.diff(ids) > 0).all() else reached


def write_ply(path: str | Path, skeleton: Skeleton) -> None:
    """Coloured edges: opens in CloudCompare, MeshLab and Blender. Nodes keep label and radius.

    The colour of a node is that of its edge from the parent.
    """
    colour = np.array([COLOURS[Label(label)] for label in skeleton.label], np.uint8)
    nodes: dict[str, Any] = {
        **{name: skeleton.xyz[:, axis] for axis, name in enumerate("xyz")},
        **{name: colour[:, c] for c, name in enumerate(("red", "green", "blue"))},
        "label": skeleton.label.astype(np.uint8),
        "radius": _zero_if_unknown(skeleton.radius),
    }
    edges: dict[str, Any] = {
        "vertex1": skeleton.edges[:, 0].astype(np.int32),
        "vertex2": skeleton.edges[:, 1].astype(np.int32),
        **{name: colour[1:, c] for c, name in enumerate(("red", "green", "blue"))},
    }
    comments = [
        "prunus skeleton; unit: metre; frame: that of the input file",
        "label: " + ", ".join(f"{int(label)} = {label.word}" for label in Label),
    ]
    tables = {"vertex": table_of(nodes), "edge": table_of(edges)}
    write_bytes(Path(path), ply_bytes(tables, comments))


def write_graphml(path: str | Path, skeleton: Skeleton) -> None:
    """GraphML with all that `Skeleton.to_networkx` holds: for yEd, Gephi, igraph, networkx.

    What is unknown has no entry: readers do not agree on how NaN is written.
    """
    import networkx as nx

    graph = skeleton.to_networkx()
    for *_, columns in (*graph.nodes(data=True), *graph.edges(data=True)):
        for name in [name for name, value in columns.items() if value != value]:
            del columns[name]
    write_bytes(Path(path), "\n".join(nx.generate_graphml(graph)).encode())


def _zero_if_unknown(radius: Floats) -> Floats:
    return np.nan_to_num(radius, nan=0.0)
