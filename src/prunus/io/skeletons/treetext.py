"""The tree file of raycloudtools and treetools: one line a tree, its segments in a row."""

from __future__ import annotations

from pathlib import Path

from prunus.files.safely import write_bytes
from prunus.io.skeletons.export import COLOURS
from prunus.model import Label, Skeleton


def write_treetext(path: str | Path, skeleton: Skeleton) -> None:
    """A segment a node: it ends there, and starts at that of its parent; the base has -1.

    Behind the fields that every reader wants stand the label (0 trunk, 1 support, 2 leader, 3 side
    branch) and its colour.
    """
    segments = []
    for row in range(len(skeleton)):
        x, y, z = skeleton.xyz[row]
        label = Label(skeleton.label[row])
        red, green, blue = COLOURS[label]
        segments.append(
            f"{x:.6f},{y:.6f},{z:.6f},{skeleton.radius[row]:.6f},{skeleton.parent[row]},"
            f"{label:d},{red},{green},{blue}"
        )
    lines = [
        "# prunus skeleton; unit: metre; frame: that of the input file",
        "x,y,z,radius,parent_id,label,red,green,blue",
        ", ".join(segments),
    ]
    write_bytes(Path(path), ("\n".join(lines) + "\n").encode())
