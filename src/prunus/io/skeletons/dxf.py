"""DXF: a coloured 3D polyline for each branch, in a layer of its label; for CloudCompare and CAD.

Release 12, the oldest: its few lines are read by every program that reads DXF at all.
"""

from __future__ import annotations

from pathlib import Path

from prunus.files.safely import write_bytes
from prunus.model import Floats, Label, Skeleton
from prunus.model.branches import branches

COLOURS = {Label.TRUNK: 7, Label.SUPPORT: 30, Label.LEADER: 150, Label.SIDE_BRANCH: 122}
"""Of the numbered colours those near to ours; 7 is white on dark screens and black on paper."""

IS_3D, VERTEX_OF_3D = 8, 32
"""Flags of a polyline and of its vertices."""


def write_dxf(path: str | Path, skeleton: Skeleton) -> None:
    """A polyline a branch, from where it leaves the one that carries it; to the micrometre."""
    pairs: list[tuple[int, object]] = [
        (999, "prunus skeleton; unit: metre; frame: that of the input file"),
        *_section("HEADER"), (9, "$ACADVER"), (1, "AC1009"), (0, "ENDSEC"),
        *_section("ENTITIES"),
    ]  # fmt: skip
    for branch in branches(skeleton):
        pairs += _polyline(skeleton.xyz[branch.rows], branch.label)
    pairs += [(0, "ENDSEC"), (0, "EOF")]
    write_bytes(Path(path), "".join(f"{code:3d}\n{value}\n" for code, value in pairs).encode())


def _section(name: str) -> list[tuple[int, object]]:
    return [(0, "SECTION"), (2, name)]


def _polyline(line: Floats, label: Label) -> list[tuple[int, object]]:
    """A polyline through points (R, 3)."""
    layer = (8, label.word)
    pairs = [(0, "POLYLINE"), layer, (62, COLOURS[label]), (66, 1), *_at((0, 0, 0)), (70, IS_3D)]
    for place in line.tolist():
        pairs += [(0, "VERTEX"), layer, *_at(place), (70, VERTEX_OF_3D)]
    return [*pairs, (0, "SEQEND"), layer]


def _at(place: tuple[float, ...]) -> list[tuple[int, object]]:
    return [(code, f"{value:.6f}") for code, value in zip((10, 20, 30), place, strict=True)]
