"""Skeletons for other tools: coloured PLY edges, GraphML."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from prunus.files.safely import write_bytes
from prunus.model import Label, Skeleton

COLOURS = {
    Label.TRUNK: (0, 0, 0),
    Label.SUPPORT: (213, 94, 0),
    Label.LEADER: (0, 114, 178),
    Label.SIDE_BRANCH: (0, 158, 115),
}
"""Red, green, blue of each label: Okabe and Ito's palette, which colour-blind people tell apart."""

COLOUR_PROPERTIES = [f"property uchar {name}" for name in ("red", "green", "blue")]


def write_ply(path: str | Path, skeleton: Skeleton) -> None:
    """Coloured edges for MeshLab, Blender, Open3D and trimesh; nodes keep label and radius.

    The colour of a node is that of its edge from the parent. Written as text: of a binary file
    trimesh takes no edges that have colours, and Open3D no colours but those of edges.
    """
    colours = [COLOURS[Label(label)] for label in skeleton.label]
    radius = np.nan_to_num(skeleton.radius, nan=0.0)
    nodes = zip(skeleton.xyz.tolist(), colours, skeleton.label, radius.tolist(), strict=True)
    edges = zip(skeleton.edges.tolist(), colours[1:], strict=True)
    lines = [
        "ply",
        "format ascii 1.0",
        "comment prunus skeleton; unit: metre; frame: that of the input file",
        "comment label: " + ", ".join(f"{int(label)} = {label.word}" for label in Label),
        f"element vertex {len(skeleton)}",
        *(f"property double {axis}" for axis in "xyz"),
        *COLOUR_PROPERTIES,
        "property uchar label",
        "property double radius",
        f"element edge {len(skeleton) - 1}",
        "property int vertex1",
        "property int vertex2",
        *COLOUR_PROPERTIES,
        "end_header",
        *(_row(*xyz, *colour, int(label), thick) for xyz, colour, label, thick in nodes),
        *(_row(*ends, *colour) for ends, colour in edges),
    ]
    write_bytes(Path(path), ("\n".join(lines) + "\n").encode())


def _row(*values: float) -> str:
    return " ".join(map(repr, values))


def write_graphml(path: str | Path, skeleton: Skeleton) -> None:
    """GraphML with all that `Skeleton.to_networkx` holds: for yEd, Gephi, igraph, networkx."""
    import networkx as nx

    text = "\n".join(nx.generate_graphml(skeleton.to_networkx()))
    write_bytes(Path(path), text.encode())
