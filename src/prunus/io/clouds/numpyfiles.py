"""Arrays of numpy: NPY and NPZ, read without unpickling, and never larger than the file.

numpy's own reader allocates what a header promises before it looks for it.
"""

from __future__ import annotations

import ast
import io
import re
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prunus.errors import PrunusError
from prunus.io.clouds.columns import Content, check_first, colour_bytes, content_of
from prunus.model.arrays import Floats

MAGIC = b"\x93NUMPY"
LARGEST_BYTES = 2**32
"""No array of an archive may unpack to more."""
POINTS, RGB = ("xyz", "points"), ("rgb", "colors", "colours")
"""What arrays of an archive are called."""


def read_npy(content: bytes, path: Path) -> Content:
    """Points of an NPY: numbers (P, 3 and more), (H, W, 3), or a table with x, y, z and colours."""
    if not content.startswith(MAGIC):
        raise PrunusError(f"{path}: not a numpy file: expected it to begin as NPY does")
    return _content(npy_array(content), path)


def read_npz(content: bytes, path: Path) -> Content:
    """Points of the array `xyz` or `points`, or of the only one; colours of `rgb` or `colors`."""
    if not content.startswith(b"PK"):
        raise PrunusError(f"{path}: not a numpy file: expected it to begin as NPZ does")
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        named = {entry.filename.removesuffix(".npy").lower(): entry for entry in archive.infolist()}
        only = next(iter(named.values())) if len(named) == 1 else None
        entry = next((named[name] for name in POINTS if name in named), only)
        if entry is None:
            raise PrunusError(f"{path}: holds {', '.join(named)}; expected an array 'xyz'")
        found = _content(npy_array(_unpacked(archive, entry, path)), path)
        colours = next((named[name] for name in RGB if name in named), None)
        if colours is None:
            return found
        rgb = npy_array(_unpacked(archive, colours, path))
    if rgb.ndim > 1 and rgb.shape[-1] == 4:
        rgb = rgb[..., :3]
    if rgb.ndim < 2 or rgb.shape[-1] != 3 or rgb.reshape(-1, 3).shape != found.xyz.shape:
        raise PrunusError(f"{path}: rgb has shape {rgb.shape}; expected {found.xyz.shape}")
    held = colour_bytes(rgb.reshape(-1, 3))
    notes = [] if held is not None else ["no colours: rgb holds something else"]
    return Content(xyz=found.xyz, rgb=held, notes=[*found.notes, *notes])


def npy_array(content: bytes) -> NDArray[Any]:
    """The array of an NPY; ValueError where it holds objects, or less than its header promises."""
    if not content.startswith(MAGIC) or len(content) < 12:
        raise ValueError("not an NPY")
    size = 2 if content[6] == 1 else 4
    begin = 8 + size + int.from_bytes(content[8 : 8 + size], "little")
    text = content[8 + size : begin].decode("latin-1" if content[6] < 3 else "utf-8")
    # Python 2 wrote its long integers as 3L.
    told = ast.literal_eval(re.sub(r"(?<=[0-9])L(?=[,)])", "", text))
    if not isinstance(told, dict) or not told.keys() >= {"descr", "fortran_order", "shape"}:
        raise ValueError(f"the header is {text[:60]!r}")
    kind, shape = np.lib.format.descr_to_dtype(told["descr"]), told["shape"]
    if not isinstance(shape, tuple) or not all(type(length) is int for length in shape):
        raise ValueError(f"the shape is {shape!r}")
    if kind.hasobject:
        raise ValueError("holds Python objects; expected numbers")
    if min(shape, default=0) < 0:
        raise ValueError(f"a shape of {shape}")
    count = 1
    for length in shape:
        count *= length
    if count * kind.itemsize > len(content) - begin:
        raise ValueError(
            f"truncated: the header promises {count * kind.itemsize} bytes, "
            f"the file holds {max(len(content) - begin, 0)}"
        )
    values = np.frombuffer(content, kind, count, begin)
    return values.reshape(shape, order="F" if told["fortran_order"] else "C")


def _unpacked(archive: zipfile.ZipFile, entry: zipfile.ZipInfo, path: Path) -> bytes:
    """An entry of an archive; PrunusError where it would unpack to too much."""
    if entry.file_size > LARGEST_BYTES:
        raise PrunusError(
            f"{path}: {entry.filename} would unpack to {entry.file_size} bytes; expected "
            f"{LARGEST_BYTES} at most"
        )
    with archive.open(entry) as held:
        return held.read(entry.file_size)


def _content(values: NDArray[Any], path: Path) -> Content:
    if values.dtype.names:
        return content_of(values.reshape(-1), values.dtype.names, path)
    found = f"holds {values.dtype} of shape {values.shape}"
    if values.dtype.kind not in "fiu" or values.ndim not in (2, 3) or values.shape[-1] < 3:
        across = ", transposed" if values.ndim == 2 and values.shape[0] == 3 else ""
        raise PrunusError(f"{path}: {found}; expected numbers (P, 3){across}")
    columns = values.shape[-1]
    if columns > max(3, len(values)):
        raise PrunusError(f"{path}: {found}: points across, it seems; expected (P, 3)")
    notes = []
    if columns > 3:
        check_first(values.reshape(-1, columns), path)
        notes.append(f"{columns} columns without names: 1 to 3 are read as x, y, z")
    if values.shape == (3, 3):
        notes.append("3 x 3 numbers: each row is read as a point")
    return Content(xyz=_xyz(values), notes=notes)


def _xyz(values: NDArray[Any]) -> Floats:
    return np.array(values.reshape(-1, values.shape[-1])[:, :3], np.float64)
