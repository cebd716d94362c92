"""Laser scans: LAS and LAZ, with the unit that their header tells."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np

from prunus.errors import PrunusError
from prunus.io.clouds.columns import Content, colour_bytes
from prunus.io.clouds.units import unit_of
from prunus.io.lidar.laz import check_chunks
from prunus.io.lidar.reference import Reference, of_keys, of_wkt
from prunus.model.arrays import Floats

CHUNK_BYTES = 2**26
"""Points are unpacked in so many bytes: what a header promises is never allocated at once."""
RECORD_BYTES, LONG_RECORD_BYTES = 54, 60
"""The shortest record of a header, and the shortest behind the points (LAS 1.4)."""
DIRECTORY, DOUBLES, WKT = 34735, 34736, 2112
"""Records of the header that hold the GeoTIFF keys, their decimals, and the WKT."""


def read_las(content: bytes, path: Path) -> Content:
    """Points, colours and unit of a LAS or LAZ. Points that are withheld are left out.

    PrunusError where it holds fewer points than its header promises.
    """
    import laspy

    _check_records(content, path)
    # One thread: the other reader of lazrs allocates whole chunks, as long as the file says.
    one = [laspy.LazBackend.Lazrs]
    with laspy.open(io.BytesIO(content), closefd=False, laz_backend=one) as las:
        header = las.header
        _check_size(header, len(content), path)
        if header.are_points_compressed and header.point_count:
            check_chunks(content, header, path)
        parts = [_columns(points) for points in las.chunk_iterator(_chunk(header))]
    xyz = np.concatenate([xyz for xyz, _, _ in parts]) if parts else np.empty((0, 3))
    colours = [rgb for _, rgb, _ in parts if rgb is not None]
    rgb = colour_bytes(np.concatenate(colours)) if colours else None
    if len(xyz) < header.point_count:
        raise _truncated(header, len(xyz), path)
    kept = ~np.concatenate([withheld for *_, withheld in parts]) if parts else np.zeros(0, bool)
    notes = []
    if not kept.all():
        notes.append(f"{(~kept).sum()} of {len(kept)} points are withheld and were left out")
        xyz, rgb = xyz[kept], None if rgb is None else rgb[kept]
    told = _reference(header)
    if told.metres and told.up and told.up != told.metres:
        xyz[:, 2] *= told.up / told.metres
        notes.append(
            f"the header gives heights in {unit_of(told.up)}, x and y in {unit_of(told.metres)}: "
            f"heights were brought to {unit_of(told.metres)}"
        )
    return Content(
        xyz=xyz,
        rgb=rgb,
        metres=told.metres,
        notes=[*notes, *told.notes],
        fault=told.fault,
        sure=True,
    )


def _check_records(content: bytes, path: Path) -> None:
    """That the file can hold the records it promises: laspy reads them one by one, to the last."""
    records, behind = int.from_bytes(content[100:104], "little"), 0
    if content[25:26] >= b"\x04":
        behind = int.from_bytes(content[243:247], "little")
    if records * RECORD_BYTES + behind * LONG_RECORD_BYTES > len(content):
        raise PrunusError(
            f"{path}: not a readable LAS or LAZ file: {records + behind} records in the header of "
            f"{len(content)} bytes"
        )


def _chunk(header: Any) -> int:
    """How many points are unpacked together."""
    return max(1, CHUNK_BYTES // int(header.point_format.size))


def _check_size(header: Any, size: int, path: Path) -> None:
    if not (np.all(np.isfinite(header.scales)) and np.all(header.scales != 0)):
        raise PrunusError(f"{path}: the header scales by {header.scales}; expected other numbers")
    there = (size - header.offset_to_point_data) // header.point_format.size
    if not header.are_points_compressed and there < header.point_count:
        raise _truncated(header, max(there, 0), path)


def _truncated(header: Any, found: int, path: Path) -> PrunusError:
    return PrunusError(
        f"{path}: truncated: the header promises {header.point_count} points, "
        f"the file holds {found}"
    )


def _columns(points: Any) -> tuple[Floats, Any, Any]:
    """Xyz (P, 3), colours (P, 3) as they are or None, and which (P,) are withheld."""
    xyz = np.column_stack([np.asarray(points[axis], np.float64) for axis in "xyz"])
    named = set(points.point_format.dimension_names)
    rgb = None
    if {"red", "green", "blue"} <= named:
        rgb = np.column_stack([points[name] for name in ("red", "green", "blue")])
    return xyz, rgb, np.asarray(points["withheld"]).astype(bool)


def _reference(header: Any) -> Reference:
    """What the header tells of the coordinates: its WKT where it has one, else its keys."""
    records = [*header.vlrs, *(header.evlrs or [])]
    held = {r.record_id: r.record_data_bytes() for r in records if r.user_id == "LASF_Projection"}
    if WKT in held and held[WKT].strip(b"\0 "):
        return of_wkt(held[WKT].decode("utf-8", "replace"))
    if DIRECTORY in held:
        return of_keys(held[DIRECTORY], held.get(DOUBLES, b""))
    return Reference()
