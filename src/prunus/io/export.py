"""Skeletons for other tools: coloured PLY edges, GraphML."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from prunus.io.ply import ply_bytes, table_of
from prunus.io.safely import write_bytes
from prunus.model import Floats, Label, Skeleton

COLOURS = {
    Label.TRUNK: (0, 0, 0),
    Label.SUPPORT: (213, 94, 0),
    Label.LEADER: (0, 114, 178),
    Label.SIDE_BRANCH: (0, 158, 115),
}
"""Red, green, blue of each label: Okabe and Ito's palette, which colour-blind people tell apart."""


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
