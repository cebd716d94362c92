"""A simulated orchard on disk: one folder a tree, a pure function of its seed.

`scan.ply` is the cloud with the truth of every point, `truth.json` the target's true skeleton
from the lowest point of its trunk that the scan holds,
`trees.npz` all true trees in view, and, where wanted, `rig.json` with six 16-bit depth images
(millimetres) as the rig recorded them.
"""

from __future__ import annotations

import io
import json
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np

from prunus.errors import PrunusError
from prunus.io.ply import ply_bytes, read_ply, table_of
from prunus.io.safely import read_bytes, write_bytes
from prunus.io.skeletons import write_skeleton
from prunus.measure import branches
from prunus.model import Floats, Ints, Skeleton
from prunus.simulate.row import NONE, Kind
from prunus.simulate.scan import Scan, simulate_scan
from prunus.simulate.settings import Setting

SHORT = 1e-3
"""Depth images count millimetres."""


@dataclass(frozen=True, eq=False)
class ScannedTree:
    """What `read_scan` gives back: xyz (P, 3), kind (P,), and the true trees, the target first."""

    name: str
    xyz: Floats
    kind: Ints
    trees: list[Skeleton]


def simulate_orchard(
    folder: Path, seeds: range, setting: Setting, views: bool, jobs: int
) -> Iterator[Path]:
    """Simulate and write one tree a seed; the folders as they are done."""
    make = partial(simulate_tree, folder, setting=setting, views=views)
    if jobs == 1:
        yield from map(make, seeds)
        return
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        yield from pool.map(make, seeds)


def simulate_tree(folder: Path, seed: int, setting: Setting, views: bool) -> Path:
    """Simulate the tree of a seed and write it below the folder; its own folder."""
    own = folder / f"tree_{seed:06d}"
    write_scan(own, simulate_scan(seed, setting), views)
    return own


def write_scan(folder: Path, scan: Scan, views: bool = False) -> None:
    """Write `scan.ply`, `truth.json`, `trees.npz` and, with `views`, the rig's images."""
    wood = [_of_rows(tree) for tree in scan.row.trees]
    branch, label = np.full(len(scan.xyz), NONE), np.full(len(scan.xyz), NONE)
    for k, (branch_of, label_of) in enumerate(wood):
        own = scan.tree == k
        branch[own], label[own] = branch_of[scan.node[own]], label_of[scan.node[own]]
    columns: dict[str, Any] = {
        name: scan.xyz[:, axis].astype(np.float32) for axis, name in enumerate("xyz")
    }
    truth = {
        "kind": scan.kind.astype(np.uint8), "tree": scan.tree.astype(np.int16),
        "branch": branch.astype(np.int16), "label": label.astype(np.int8),
    }  # fmt: skip
    words = ", ".join(f"{kind.value} {kind.name.lower()}" for kind in Kind)
    comments = [f"kind: {words}", "label: 0 trunk, 1 support, 2 leader, 3 side branch, -1 none"]
    write_bytes(folder / "scan.ply", ply_bytes({"vertex": table_of(columns | truth)}, comments))
    write_skeleton(folder / "truth.json", scan.truth)
    if views:
        _write_views(folder, scan)
    write_bytes(folder / "trees.npz", _trees_bytes(scan.row.trees))


def read_scan(folder: Path) -> ScannedTree:
    """Read what `write_scan` wrote; PrunusError naming the file otherwise."""
    path = folder / "scan.ply"
    vertex = read_ply(read_bytes(path), path)["vertex"]
    missing = {"x", "y", "z", "kind"} - set(vertex.dtype.names or ())
    if missing:
        raise PrunusError(f"{path}: no property {sorted(missing)[0]!r}; expected a simulated scan")
    xyz = np.column_stack([vertex[axis].astype(np.float64) for axis in "xyz"])
    trees = _read_trees(folder / "trees.npz")
    return ScannedTree(folder.name, xyz, vertex["kind"].astype(np.int64), trees)


def scans_in(folder: Path) -> list[Path]:
    """The folders of simulated trees in a folder, by name; PrunusError where there are none."""
    found = sorted(path.parent for path in folder.glob("*/trees.npz"))
    if not found:
        raise PrunusError(
            f"{folder}: no simulated tree in it; expected folders with scan.ply and trees.npz, "
            "as `prunus simulate` writes them"
        )
    return found


def _of_rows(tree: Skeleton) -> tuple[Ints, Ints]:
    """Number of the branch and label of each row (M,)."""
    number = np.zeros(len(tree), np.int64)
    for k, branch in enumerate(branches(tree)):
        number[branch.rows[1:]] = k
    return number, tree.label.astype(np.int64)


def _trees_bytes(trees: list[Skeleton]) -> bytes:
    held = io.BytesIO()
    np.savez_compressed(
        held,
        rows=[len(tree) for tree in trees],
        xyz=np.concatenate([tree.xyz for tree in trees]),
        parent=np.concatenate([tree.parent for tree in trees]),
        label=np.concatenate([tree.label for tree in trees]),
        radius=np.concatenate([tree.radius for tree in trees]),
    )
    return held.getvalue()


def _read_trees(path: Path) -> list[Skeleton]:
    try:
        with np.load(io.BytesIO(read_bytes(path)), allow_pickle=False) as held:
            ends = np.cumsum(held["rows"])[:-1]
            names = ("xyz", "parent", "label", "radius")
            parts = [np.split(held[name], ends) for name in names]
    except (ValueError, KeyError, OSError) as error:
        raise PrunusError(f"{path}: not a file of true trees ({error})") from error
    return [Skeleton.build(*part[:3], radius=part[3]) for part in zip(*parts, strict=True)]


def _write_views(folder: Path, scan: Scan) -> None:
    """`rig.json`, poses from camera to house frame, and `view_0.npy` to `view_5.npy`."""
    rig: dict[str, Any] = {"format": "prunus-rig", "version": 1, "unit": "m", "views": []}
    for k, view in enumerate(scan.views):
        held = io.BytesIO()
        np.save(held, np.rint(view.depth / SHORT).astype(np.uint16))
        write_bytes(folder / f"view_{k}.npy", held.getvalue())
        height, width = view.depth.shape
        rig["views"].append(
            {
                "depth": f"view_{k}.npy", "depth_unit": SHORT, "width": width, "height": height,
                "fx": scan.focal, "fy": scan.focal, "cx": width / 2, "cy": height / 2,
                "rotation": view.nominal.rotation.tolist(),
                "translation": view.nominal.translation.tolist(),
            }
        )  # fmt: skip
    write_bytes(folder / "rig.json", json.dumps(rig, indent=1).encode())
