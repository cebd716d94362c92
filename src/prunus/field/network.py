"""The network of the point field: a sparse U-Net in ONNX, run over the voxels of a cloud."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from prunus.field.votes import PointField
from prunus.field.voxels import LEVELS, Voxels
from prunus.model import Floats, Role
from prunus.weights import WEIGHTS, open_network

SHIPPED = WEIGHTS / "field.onnx"
OFFSET_M = 0.03
"""An offset of 1 is so long."""
RADIUS_M = 0.01
"""A log radius of 0 is this."""
COLUMNS = {"role": len(Role), "offset": 3, "log_radius": 1, "toward_foot": 3}
"""What the network tells of each voxel, side by side."""
TABLES = [f"neighbours_{level}" for level in range(LEVELS)] + [
    f"{table}_{level}" for level in range(LEVELS - 1) for table in ("parent", "children")
]
"""The tables by which it walks over the voxels of each level."""
SHOWN, TOLD = frozenset({"features", *TABLES}), frozenset({"outputs"})


def see_field(voxels: Voxels, path: Path = SHIPPED) -> PointField:
    """What the network says of the voxels of a cloud, Z up: the same for the same voxels.

    PrunusError where the file holds no such network.
    """
    session = open_network(path, (SHOWN,), TOLD)
    shown = {"features": voxels.features(), **tables_of(voxels)}
    (outputs,) = session.run(["outputs"], shown)
    return field_of(voxels, np.asarray(outputs, np.float64))


def tables_of(voxels: Voxels) -> dict[str, Any]:
    """The tables of the voxels, by the names of the inputs."""
    levels = voxels.levels
    found = {f"neighbours_{number}": level.neighbours for number, level in enumerate(levels)}
    for number, level in enumerate(levels[:-1]):
        found[f"parent_{number}"] = level.parent
        found[f"children_{number}"] = level.children
    return found


def field_of(voxels: Voxels, outputs: Floats) -> PointField:
    """The field of voxels of which the network told that (V, 13)."""
    ends = np.cumsum(list(COLUMNS.values()))[:-1]
    logits, offset, log_radius, toward_foot = np.split(outputs, ends, axis=1)
    chance = np.exp(logits - logits.max(axis=1, keepdims=True))
    length = np.linalg.norm(toward_foot, axis=1, keepdims=True)
    return PointField(
        xyz=voxels.xyz,
        count=voxels.count,
        role=chance / chance.sum(axis=1, keepdims=True),
        offset=OFFSET_M * offset,
        radius=RADIUS_M * np.exp(log_radius[:, 0]),
        toward_foot=toward_foot / np.maximum(length, 1e-9),
    )
