"""A rig's folder: `rig.json` with depth images or partial clouds, or partial clouds alone.

`docs/fuse.md` describes the file.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, FiniteFloat

from prunus.errors import PrunusError
from prunus.files.reading import record_in
from prunus.io.clouds.cloud_file import read_cloud
from prunus.io.images import read_colour, read_depth, read_mask
from prunus.model import Camera, CloudView, DepthView, Floats, RigidMotion, RigView
from prunus.names import as_text

Row = tuple[FiniteFloat, FiniteFloat, FiniteFloat]
Positive = Annotated[FiniteFloat, Field(gt=0)]

SKEWED = 1e-3
"""A rotation may be off an orthonormal matrix by so much in any entry of R R^T."""


class ViewRecord(BaseModel):
    """One view: a depth image with its camera, or a partial cloud; and its nominal pose."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    depth: str | None = Field(None, description="16-bit NPY or PNG, 0 = nothing")
    cloud: str | None = Field(None, description="in place of a depth image")
    depth_unit: Positive = Field(0.001, description="metres in one step of the depth image")
    width: int | None = Field(None, gt=0, description="pixels")
    height: int | None = Field(None, gt=0, description="pixels")
    fx: Positive | None = None
    fy: Positive | None = None
    cx: FiniteFloat | None = None
    cy: FiniteFloat | None = None
    rotation: tuple[Row, Row, Row] = Field(description="from the view to the rig")
    translation: Row = Field(description="metres")
    colour: str | None = Field(None, description="image of the size of the depth image")
    mask: str | None = Field(None, description="likewise; 0 = leave out")


class RigFile(BaseModel):
    """The contents of `rig.json`."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    format: Literal["prunus-rig"]
    version: Literal[1]
    unit: Literal["m"]
    views: list[ViewRecord] = Field(min_length=1)


def read_rig(folder: str | Path) -> list[RigView]:
    """The views of a rig's folder: by its `rig.json`, else each `*_cloud.ply` where it lies.

    Raises PrunusError naming the file, what was found and what was expected.
    """
    folder = Path(folder)
    if not folder.is_dir():
        raise PrunusError(f"{folder}: not a folder; expected one with rig.json or *_cloud.ply")
    file = folder / "rig.json"
    if file.exists():
        records = record_in(file, RigFile).views
        return [_view(record, file, f"views.{k}") for k, record in enumerate(records)]
    clouds = sorted(path for path in folder.glob("*_cloud.ply") if path.name[0] != ".")
    if not clouds:
        raise PrunusError(f"{folder}: holds neither rig.json nor *_cloud.ply; expected one of them")
    still = RigidMotion(np.eye(3), np.zeros(3))
    return [_cloud(path, still) for path in clouds]


def _view(record: ViewRecord, file: Path, where: str) -> RigView:
    pose = RigidMotion(_rotation(record, file, where), np.array(record.translation))
    if (record.depth is None) == (record.cloud is None):
        found = "neither" if record.depth is None else "both"
        raise PrunusError(f"{file}: {where}: {found} of depth and cloud; expected one of them")
    if record.cloud is not None:
        return _cloud(file.parent / record.cloud, pose)
    return _depth(record, file, where, pose)


def _cloud(path: Path, pose: RigidMotion) -> CloudView:
    held = read_cloud(path)
    return CloudView(name=as_text(path.name), xyz=held.xyz, nominal=pose, rgb=held.rgb)


def _depth(record: ViewRecord, file: Path, where: str, pose: RigidMotion) -> DepthView:
    path = file.parent / str(record.depth)
    depth = read_depth(path) * record.depth_unit
    expected = (record.height or depth.shape[0], record.width or depth.shape[1])
    if depth.shape != expected:
        raise PrunusError(f"{path}: the image is {_size(depth.shape)}; expected {_size(expected)}")
    colour, mask = None, None
    if record.colour is not None:
        colour = read_colour(file.parent / record.colour, expected)
    if record.mask is not None:
        mask = read_mask(file.parent / record.mask, expected)
    return DepthView(
        name=as_text(path.name),
        depth=depth,
        camera=_camera(record, file, where),
        nominal=pose,
        rgb=colour,
        mask=mask,
    )


def _camera(record: ViewRecord, file: Path, where: str) -> Camera:
    numbers = {name: getattr(record, name) for name in ("fx", "fy", "cx", "cy")}
    missing = [name for name, number in numbers.items() if number is None]
    if missing:
        raise PrunusError(f"{file}: {where}.{missing[0]}: missing; a depth image needs its camera")
    return Camera(**numbers)


def _rotation(record: ViewRecord, file: Path, where: str) -> Floats:
    """The rotation (3, 3) nearest to the one that the file gives."""
    given = np.array(record.rotation)
    off = float(np.abs(given @ given.T - np.eye(3)).max())
    if off > SKEWED or np.linalg.det(given) < 0:
        raise PrunusError(
            f"{file}: {where}.rotation: R R^T is off the identity by {off:.2g} and the determinant "
            f"is {np.linalg.det(given):.2g}; expected a rotation"
        )
    left, _, right = np.linalg.svd(given)
    return np.asarray(left @ right)


def _size(shape: tuple[int, ...]) -> str:
    height, width = shape
    return f"{height} rows x {width} columns"
