"""A simulated orchard on disk: one folder a tree, a pure function of its seed.

Beside what `io.scans` describes there is, where wanted, `rig.json` with six 16-bit depth images
(millimetres) as the rig recorded them, and the poses that it believes in.
"""

from __future__ import annotations

import io
import json
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from prunus.files.safely import write_bytes, written_together
from prunus.files.work_folder import SCAN, TRUTH
from prunus.io.skeletons.skeleton_file import write_skeleton
from prunus.lab.simulate.row import NONE
from prunus.lab.simulate.scan import Scan, simulate_scan
from prunus.lab.simulate.scan_folder import write_scan
from prunus.lab.simulate.settings import Setting
from prunus.model.branches import branch_of_rows, branches
from prunus.processes.workers import in_order

MILLIMETRE = 1e-3
"""Depth images count millimetres."""


def simulate_orchard(
    folder: Path, seeds: range, scan: Callable[[int], Scan], views: bool, jobs: int
) -> Iterator[Path]:
    """Write what `scan` makes of each seed, one tree a seed; the folders as they are done."""
    yield from in_order(partial(_scanned, folder, scan, views), seeds, jobs)


def simulate_tree(folder: Path, seed: int, setting: Setting, views: bool) -> Path:
    """Simulate the tree of a seed and write it below the folder; its own folder."""
    return _scanned(folder, partial(simulate_scan, setting=setting), views, seed)


def _scanned(folder: Path, scan: Callable[[int], Scan], views: bool, seed: int) -> Path:
    own = folder / f"tree_{seed:06d}"
    write_simulated(own, scan(seed), views)
    return own


def write_simulated(folder: Path, scan: Scan, views: bool = False) -> None:
    """Write a scan with its truth and, with `views`, the rig's images; scan.ply comes last."""
    branch, label = np.full(len(scan.xyz), NONE), np.full(len(scan.xyz), NONE)
    for k, tree in enumerate(scan.row.trees):
        own = scan.tree == k
        branch[own] = branch_of_rows(branches(tree), len(tree))[scan.node[own]]
        label[own] = tree.label[scan.node[own]]
    truth = {"kind": scan.kind, "tree": scan.tree, "branch": branch, "label": label}
    with written_together(folder, SCAN, older=["rig.json"]) as together:
        if views:
            _write_views(together, scan)
        write_skeleton(together / TRUTH, scan.truth)
        write_scan(together, scan.xyz, truth, scan.row.trees)


def _write_views(folder: Path, scan: Scan) -> None:
    """`rig.json`, poses from camera to house frame, and `view_0.npy` to `view_5.npy`."""
    rig: dict[str, Any] = {"format": "prunus-rig", "version": 1, "unit": "m", "views": []}
    for k, view in enumerate(scan.views):
        held = io.BytesIO()
        np.save(held, np.rint(view.depth / MILLIMETRE).astype(np.uint16))
        write_bytes(folder / f"view_{k}.npy", held.getvalue())
        height, width = view.depth.shape
        rig["views"].append(
            {
                "depth": f"view_{k}.npy", "depth_unit": MILLIMETRE,
                "width": width, "height": height,
                "fx": scan.focal, "fy": scan.focal, "cx": width / 2, "cy": height / 2,
                "rotation": view.nominal.rotation.tolist(),
                "translation": view.nominal.translation.tolist(),
            }
        )  # fmt: skip
    write_bytes(folder / "rig.json", json.dumps(rig, indent=1).encode())
