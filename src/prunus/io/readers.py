"""How each kind of cloud file is read: content in, x, y, z and colours out."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from prunus.errors import PrunusError
from prunus.io.ply import parse_rows, read_ply
from prunus.model.arrays import Bytes, Floats

Columns = tuple[Floats, Bytes | None]
"""xyz (P, 3) as in the file, rgb (P, 3) where the file has colours."""


def columns_of(table: Any, names: tuple[str, ...], path: Path | str) -> Columns:
    """x, y, z and colours among the named columns of a table; PrunusError where one is missing."""
    lower = {name.lower(): name for name in names}
    missing = [axis for axis in "xyz" if axis not in lower]
    if missing:
        raise PrunusError(
            f"{path}: no column {missing[0]!r} among {', '.join(names) or 'none'}; expected x, y, z"
        )
    xyz = np.empty((len(table[lower["x"]]), 3))
    for axis, name in enumerate("xyz"):
        xyz[:, axis] = table[lower[name]]
    for colours in (("red", "green", "blue"), ("r", "g", "b")):
        if all(colour in lower for colour in colours):
            return xyz, _bytes(np.column_stack([table[lower[colour]] for colour in colours]))
    return xyz, None


def _bytes(rgb: Any) -> Bytes:
    """Colours (P, 3) as bytes, whether they came as bytes, 16-bit numbers or shares of one."""
    if np.issubdtype(rgb.dtype, np.floating) and rgb.size and np.nanmax(rgb) <= 1:
        rgb = rgb * 255
    elif rgb.dtype == np.uint16 and rgb.size and rgb.max() > 255:
        rgb = rgb >> 8
    return np.asarray(np.clip(np.nan_to_num(rgb), 0, 255), np.uint8)


def unpacked(packed: Any) -> Bytes:
    """Colours (P, 3) from numbers (P,) of four bytes each, that hold red, green and blue."""
    bits = np.ascontiguousarray(packed, packed.dtype).view(packed.dtype.byteorder + "u4")
    return np.column_stack([bits >> 16, bits >> 8, bits]).astype(np.uint8)


def _read_ply(content: bytes, path: Path) -> Columns:
    table = read_ply(content, path)["vertex"]
    return columns_of(table, table.dtype.names or (), path)


def _read_pcd(content: bytes, path: Path) -> Columns:
    from pypcd4.pypcd4 import PointCloud as Pcd

    # pypcd4 raises whatever its parsing trips over; the file is at fault in every case.
    try:
        cloud = Pcd.from_fileobj(io.BufferedReader(io.BytesIO(content)))
        fields = cloud.fields
        table = {name: cloud.pc_data[name].reshape(-1) for name in fields}
    except Exception as error:
        raise PrunusError(f"{path}: not a readable PCD file: {error}") from error
    xyz, rgb = columns_of(table, tuple(fields), path)
    if rgb is None and "rgb" in table:
        rgb = unpacked(table["rgb"])
    return xyz, rgb


def _read_las(content: bytes, path: Path) -> Columns:
    import laspy

    # laspy and lazrs raise their own and each other's errors; the file is at fault in every case.
    try:
        las = laspy.read(io.BytesIO(content))
        xyz = np.column_stack([np.asarray(las.x), np.asarray(las.y), np.asarray(las.z)])
        named = set(las.point_format.dimension_names)
        rgb = None
        if {"red", "green", "blue"} <= named:
            rgb = _bytes(np.column_stack([las["red"], las["green"], las["blue"]]))
    except Exception as error:
        raise PrunusError(f"{path}: not a readable LAS or LAZ file: {error}") from error
    if len(xyz) < las.header.point_count:
        raise PrunusError(
            f"{path}: truncated: the header promises {las.header.point_count} points, "
            f"the file holds {len(xyz)}"
        )
    return xyz.astype(np.float64), rgb


def _read_text(content: bytes, path: Path) -> Columns:
    first = next((line for line in content.splitlines() if line.strip()), b"")
    delimiter = next((mark for mark in ",;" if mark.encode() in first), None)
    words = first.decode("latin-1").strip("#/ \t").split(delimiter)
    names = [word.strip().strip('"').lower() for word in words]
    headed = {"x", "y", "z"} <= set(names)
    if headed:
        content = content[content.index(first) + len(first) :]
    values = parse_rows(io.BytesIO(content), path, delimiter=delimiter)
    if values.shape[1] < 3:
        raise PrunusError(f"{path}: rows hold {values.shape[1]} numbers; expected x, y, z")
    if headed:
        table = {name: values[:, column] for column, name in enumerate(names[: values.shape[1]])}
        return columns_of(table, tuple(table), path)
    return values[:, :3].copy(), _bytes(values[:, 3:6]) if values.shape[1] == 6 else None


def _read_npy(content: bytes, path: Path) -> Columns:
    return _array(_load(content, path), path), None


def _read_npz(content: bytes, path: Path) -> Columns:
    arrays = _load(content, path)
    if not isinstance(arrays, np.lib.npyio.NpzFile):
        raise PrunusError(f"{path}: holds one array; expected an NPZ archive")
    named = {name.lower(): name for name in arrays.files}
    key = next((named[name] for name in ("xyz", "points") if name in named), None)
    if key is None and len(named) == 1:
        key = next(iter(named.values()))
    if key is None:
        raise PrunusError(f"{path}: holds {', '.join(arrays.files)}; expected an array 'xyz'")
    rgb = next((named[name] for name in ("rgb", "colors") if name in named), None)
    try:
        xyz = _array(arrays[key], path)
        colours = None if rgb is None else _bytes(arrays[rgb])
    except (ValueError, OSError, EOFError, zipfile.BadZipFile) as error:
        raise PrunusError(f"{path}: {error}") from error
    if colours is not None and colours.shape != xyz.shape:
        raise PrunusError(f"{path}: rgb has shape {colours.shape}; expected {xyz.shape}")
    return xyz, colours


def _load(content: bytes, path: Path) -> Any:
    if not content.startswith((b"\x93NUMPY", b"PK")):
        raise PrunusError(f"{path}: not a numpy file: expected it to begin as NPY or NPZ does")
    try:
        return np.load(io.BytesIO(content), allow_pickle=False)
    except (ValueError, OSError, EOFError, zipfile.BadZipFile) as error:
        raise PrunusError(f"{path}: not a readable numpy file: {error}") from error


def _array(values: Any, path: Path) -> Floats:
    if values.dtype.names:
        return columns_of(values, values.dtype.names, path)[0]
    if values.ndim != 2 or values.shape[1] < 3 or values.dtype.kind not in "fiu":
        raise PrunusError(
            f"{path}: holds {values.dtype} of shape {values.shape}; expected numbers (P, 3)"
        )
    return np.asarray(values[:, :3], np.float64)


READERS: dict[str, Callable[[bytes, Path], Columns]] = {
    ".ply": _read_ply,
    ".pcd": _read_pcd,
    ".xyz": _read_text,
    ".txt": _read_text,
    ".csv": _read_text,
    ".las": _read_las,
    ".laz": _read_las,
    ".npy": _read_npy,
    ".npz": _read_npz,
}
"""How each kind of file is read, by its ending."""
