"""How each kind of cloud file is read, by its ending: content in, points, colours and unit out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from prunus.io.clouds.columns import Content, content_of
from prunus.io.clouds.numpyfiles import read_npy, read_npz
from prunus.io.clouds.pcd import read_pcd
from prunus.io.clouds.text import read_text
from prunus.io.clouds.units import unit_called
from prunus.io.lidar.e57 import read_e57
from prunus.io.lidar.las import read_las
from prunus.io.ply import ply_comments, read_ply


def _read_ply(content: bytes, path: Path) -> Content:
    table = read_ply(content, path)["vertex"]
    found = content_of(table, table.dtype.names or (), path)
    told = [c.partition("unit:")[2] for c in ply_comments(content, path) if "unit:" in c]
    units = {unit_called(words.split(";")[0]) for words in told}
    return replace(found, metres=units.pop()) if len(units) == 1 else found


READERS: dict[str, Callable[[bytes, Path], Content]] = {
    ".ply": _read_ply,
    ".pcd": read_pcd,
    ".xyz": read_text,
    ".txt": read_text,
    ".csv": read_text,
    ".asc": read_text,
    ".pts": read_text,
    ".las": read_las,
    ".laz": read_las,
    ".e57": read_e57,
    ".npy": read_npy,
    ".npz": read_npz,
}
"""How each kind of file is read, by its ending."""
