"""Raw scans with the truth of every point, one folder a tree, as `prunus simulate` writes them.

`scan.ply` is the cloud with kind, tree, branch and label of every point, `truth.json` the target's
true skeleton from the lowest point of its trunk that the scan holds, `trees.npz` all true trees in
view, the target first.
"""

from __future__ import annotations

import io
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from prunus.errors import PrunusError
from prunus.files.safely import parsing, read_bytes, write_bytes
from prunus.files.work_folder import SCAN, TREES
from prunus.io.ply import ply_bytes, read_ply, table_of
from prunus.model import Floats, Ints, Kind, Skeleton


@dataclass(frozen=True, eq=False, kw_only=True)
class ScannedTree:
    """A scan with its truth: xyz (P, 3), and the true trees, the target first.

    Of each point: kind (P,), tree (P,) and branch (P,) of that tree, as `branches` counts
    them; -1 = none.
    """

    name: str
    xyz: Floats
    kind: Ints
    tree: Ints
    branch: Ints
    trees: list[Skeleton]


def write_scan(folder: Path, xyz: Floats, truth: dict[str, Ints], trees: list[Skeleton]) -> None:
    """Write `scan.ply` and `trees.npz`; `truth`: kind, tree, branch, label (P,), -1 = none."""
    columns: dict[str, Any] = {
        name: xyz[:, axis].astype(np.float32) for axis, name in enumerate("xyz")
    }
    columns |= {name: values.astype(_width_of(values)) for name, values in truth.items()}
    words = ", ".join(f"{kind.value} {kind.name.lower()}" for kind in Kind)
    comments = [f"kind: {words}", "label: 0 trunk, 1 support, 2 leader, 3 side branch, -1 none"]
    write_bytes(folder / SCAN, ply_bytes({"vertex": table_of(columns)}, comments))
    write_bytes(folder / TREES, _trees_bytes(trees))


def _width_of(values: Ints) -> type[np.signedinteger[Any]]:
    """The least type that holds the values: furred trees have branches by the thousand."""
    return np.int16 if values.max(initial=0) <= np.iinfo(np.int16).max else np.int32


def read_scan(folder: Path) -> ScannedTree:
    """Read what `write_scan` wrote; PrunusError naming the file otherwise."""
    path = folder / SCAN
    vertex = read_ply(read_bytes(path), path)["vertex"]
    missing = {"x", "y", "z", "kind", "tree", "branch"} - set(vertex.dtype.names or ())
    if missing:
        raise PrunusError(f"{path}: no property {min(missing)!r}; expected a simulated scan")
    xyz = np.column_stack([vertex[axis].astype(np.float64) for axis in "xyz"])
    trees = _read_trees(folder / TREES)
    kind, tree, branch = (vertex[name].astype(np.int64) for name in ("kind", "tree", "branch"))
    return ScannedTree(name=folder.name, xyz=xyz, kind=kind, tree=tree, branch=branch, trees=trees)


def scans_in(folder: Path) -> list[Path]:
    """The folders of scans in a folder, by name; PrunusError where there are none."""
    found = sorted(path.parent for path in folder.glob("*/trees.npz"))
    if not found:
        raise PrunusError(
            f"{folder}: no simulated tree in it; expected folders with scan.ply and trees.npz, "
            "as `prunus simulate` writes them"
        )
    return found


def _trees_bytes(trees: list[Skeleton]) -> bytes:
    held = io.BytesIO()
    names = ("xyz", "parent", "label", "radius")
    columns: dict[str, Any] = {
        n: np.concatenate([getattr(tree, n) for tree in trees]) for n in names
    }
    np.savez_compressed(held, rows=[len(tree) for tree in trees], **columns)
    return held.getvalue()


def _read_trees(path: Path) -> list[Skeleton]:
    content = read_bytes(path)
    with parsing(path, "file of true trees"), np.load(io.BytesIO(content)) as held:
        ends = np.cumsum(held["rows"])[:-1]
        names = ("xyz", "parent", "label", "radius")
        parts = [np.split(held[name], ends) for name in names]
        return [Skeleton.build(*p[:3], radius=p[3]) for p in zip(*parts, strict=True)]
