"""Arrays with a few words in one compressed file, and what is asked of arrays that were read.

A file is a `.npz` of plain arrays and a text. Numbers are stored as small as they go without loss.
"""

from __future__ import annotations

import io
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prunus.files.safely import parsing, read_bytes, write_bytes
from prunus.model import Floats, Ints

LARGEST = 2**30
"""No file that we write unpacks to more bytes."""
TOLD = "told"

Arrays = dict[str, NDArray[Any]]


def write_arrays(path: Path, arrays: Mapping[str, NDArray[Any]], told: str) -> None:
    """Write arrays of numbers and a text. Raises PrunusError where that cannot be done."""
    held = io.BytesIO()
    small: dict[str, Any] = {name: _small(array) for name, array in arrays.items()}
    small[TOLD] = np.array(told)
    np.savez_compressed(held, **small)
    write_bytes(path, held.getvalue())


def read_arrays(path: Path) -> tuple[Arrays, str]:
    """The arrays of a file, whole numbers as int64 and others as float64, and its text.

    Raises PrunusError where it is no such file.
    """
    content = read_bytes(path)
    with parsing(path, "file of arrays"):
        with zipfile.ZipFile(io.BytesIO(content)) as held:
            if sum(entry.file_size for entry in held.infolist()) > LARGEST:
                raise ValueError("it would unpack to over a gigabyte")
        with np.load(io.BytesIO(content), allow_pickle=False) as held:
            return {name: _wide(held[name]) for name in held if name != TOLD}, str(held[TOLD])


def finite(arrays: Arrays, name: str) -> Floats:
    """The numbers of that name; ValueError where they are not there, or not all finite."""
    values = there(arrays, name)
    if not np.isfinite(values).all():
        raise ValueError(f"{name}: holds NaN or infinity")
    return np.asarray(values, np.float64)


def shares(arrays: Arrays, name: str) -> Floats:
    """The numbers from 0 to 1 of that name; ValueError otherwise."""
    values = finite(arrays, name)
    if not ((values >= 0) & (values <= 1)).all():
        raise ValueError(f"{name}: expected numbers from 0 to 1")
    return values


def indices(arrays: Arrays, name: str, count: int, steps: bool = False) -> Ints:
    """The whole numbers from 0 to `count` - 1 of that name; ValueError otherwise.

    `steps`: what is held is how far each is from the one before, the first from 0.
    """
    values = there(arrays, name)
    if values.dtype.kind != "i":
        raise ValueError(f"{name}: expected whole numbers")
    values = np.cumsum(values) if steps else values
    if values.size and (values.min() < 0 or values.max() >= count):
        raise ValueError(f"{name}: expected numbers from 0 to {count - 1}")
    return np.asarray(values)


def there(arrays: Arrays, name: str) -> NDArray[Any]:
    """The numbers of that name; ValueError where they are not there."""
    if name not in arrays:
        raise ValueError(f"holds no {name}")
    return arrays[name]


def _small(array: NDArray[Any]) -> NDArray[Any]:
    """The same values in fewer bytes."""
    if array.dtype.kind == "f":
        with np.errstate(over="ignore"):
            single = array.astype(np.float32)
        return single if np.array_equal(single, array, equal_nan=True) else array
    ends = [int(array.min()), int(array.max())] if array.size else [0]
    return array.astype(np.result_type(*(np.min_scalar_type(end) for end in ends)))


def _wide(array: NDArray[Any]) -> NDArray[Any]:
    if array.dtype.kind not in "fiu":
        raise ValueError(f"an array of {array.dtype}; expected numbers")
    return array.astype(np.float64 if array.dtype.kind == "f" else np.int64)
