"""Laser scans as E57 (ASTM E2807): all scans of a file joined by their poses, in metres."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from prunus.errors import PrunusError
from prunus.files.safely import plainly_named
from prunus.io.clouds.columns import Columns, Content
from prunus.io.ros.transforms import rotation
from prunus.model.arrays import Bools, Bytes, Floats

CARTESIAN = ("cartesianX", "cartesianY", "cartesianZ")
SPHERICAL = ("sphericalRange", "sphericalAzimuth", "sphericalElevation")
COLOURS = ("colorRed", "colorGreen", "colorBlue")


def read_e57(content: bytes, path: Path) -> Content:
    """Points and colours of all scans. Points marked as invalid are left out, and a note says so.

    Read by pye57, which is an extra. PrunusError where a scan promises more than the file can hold.
    """
    try:
        import pye57
    except ImportError as error:
        raise PrunusError(
            f"{path}: E57 is read with pye57, which is not installed: pip install 'prunus[e57]'"
        ) from error
    with plainly_named(path) as plain, pye57.E57(str(plain)) as file:
        headers = [file.get_header(number) for number in range(file.scan_count)]
        promised = sum(header.point_count for header in headers)
        if promised > 8 * len(content):
            raise PrunusError(
                f"{path}: the header promises {promised} points in {len(content)} bytes; "
                "expected a bit a point at least"
            )
        scans = [_scan(file, header, path) for header in headers if header.point_count]
    if not scans:
        return Content(xyz=np.empty((0, 3)), metres=1.0, sure=True)
    xyz = np.concatenate([xyz for (xyz, _), _ in scans])
    colours = [rgb for (_, rgb), _ in scans if rgb is not None]
    rgb = np.concatenate(colours) if len(colours) == len(scans) else None
    notes = [f"{len(scans)} scans joined by their poses"] if len(scans) > 1 else []
    if any(COLOURS[0] in header.point_fields for header in headers) and not colours:
        notes.append("no colours: they are no bytes")
    invalid = sum(lost for _, lost in scans)
    if invalid:
        notes.append(f"{invalid} of {invalid + len(xyz)} points are marked as invalid and left out")
    return Content(xyz=xyz, rgb=rgb, metres=1.0, notes=notes, sure=True)


def _scan(file: Any, header: Any, path: Path) -> tuple[Columns, int]:
    """The valid points of a scan in the frame of the file, and how many are not."""
    there = set(header.point_fields)
    places = next((names for names in (CARTESIAN, SPHERICAL) if there.issuperset(names)), None)
    if places is None:
        raise PrunusError(
            f"{path}: a scan of {', '.join(header.point_fields)}; expected {', '.join(CARTESIAN)}"
        )
    coloured = there.issuperset(COLOURS) and _limit(header) <= 255
    state = "cartesianInvalidState" if places is CARTESIAN else "sphericalInvalidState"
    names = [*places, *(COLOURS if coloured else ()), *({state} & there)]
    data, buffers = file.make_buffers(names, header.point_count)
    found = header.points.reader(buffers).read()
    if found < header.point_count:
        raise PrunusError(
            f"{path}: truncated: the header promises {header.point_count} points, "
            f"the file holds {found}"
        )
    valid: Bools = data[state] == 0 if state in data else np.ones(found, bool)
    xyz = np.column_stack([data[name][valid] for name in places])
    rgb: Bytes | None = np.column_stack([data[c][valid] for c in COLOURS]) if coloured else None
    xyz = _cartesian(xyz) if places is SPHERICAL else xyz
    return (_placed(xyz, header.node), rgb), int((~valid).sum())


def _limit(header: Any) -> float:
    """The brightest colour there may be."""
    limits = header.node["colorLimits"] if header.node.isDefined("colorLimits") else None
    return 255 if limits is None else float(limits["colorRedMaximum"].value())


def _cartesian(seen: Floats) -> Floats:
    """x, y, z (P, 3) of range, azimuth and elevation (P, 3): metres and radians."""
    far, azimuth, elevation = seen.T
    flat = far * np.cos(elevation)
    return np.column_stack(
        [flat * np.cos(azimuth), flat * np.sin(azimuth), far * np.sin(elevation)]
    )


def _placed(xyz: Floats, node: Any) -> Floats:
    """Points (P, 3) of a scan where its pose puts them; either part of a pose may be missing."""
    if not node.isDefined("pose"):
        return xyz
    pose = node["pose"]
    if pose.isDefined("rotation"):
        turn = np.array([pose["rotation"][axis].value() for axis in "xyzw"], np.float64)
        xyz = xyz @ rotation(turn / np.linalg.norm(turn)).T
    if pose.isDefined("translation"):
        xyz = xyz + np.array([pose["translation"][axis].value() for axis in "xyz"], np.float64)
    return xyz
