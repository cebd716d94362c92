"""Images of a rig: NPY by numpy alone; PNG and the like by Pillow, which is an extra."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prunus.errors import PrunusError
from prunus.files.safely import parsing, read_bytes
from prunus.io.clouds.numpyfiles import npy_array
from prunus.model import Bools, Floats
from prunus.model.arrays import Bytes

Image = NDArray[Any]
DEEP = ("I;16", "I;16B", "I;16L", "I;16N", "I")
"""Modes in which Pillow holds grey images of 16 bits."""
GREY = ("1", "L", *DEEP)
"""Modes of one channel whose numbers mean themselves."""


def read_depth(path: Path) -> Floats:
    """A depth image (H, W) of 16-bit steps, 0 = nothing; PrunusError on anything else."""
    image = _image(path, deep=True)
    if image.dtype != np.uint16 or image.ndim != 2 or image.size == 0:
        raise PrunusError(f"{path}: {_kind(image)}; expected a grey image of 16-bit numbers (H, W)")
    return image.astype(np.float64)


def read_colour(path: Path, size: tuple[int, int]) -> Bytes:
    """A colour image (H, W, 3) of this size; PrunusError on anything else."""
    image = _image(path)
    if image.dtype != np.uint8 or image.shape != (*size, 3):
        raise PrunusError(f"{path}: {_kind(image)}; expected bytes of the shape {(*size, 3)}")
    return image


def read_mask(path: Path, size: tuple[int, int]) -> Bools:
    """A mask (H, W) of this size, true where any channel is not 0; PrunusError on anything else."""
    image = _image(path)
    if image.shape[:2] != size or image.ndim > 3:
        raise PrunusError(f"{path}: {_kind(image)}; expected an image of the shape {size}")
    return np.asarray(image.reshape(*size, -1).astype(np.bool_).any(axis=2))


def _image(path: Path, deep: bool = False) -> Image:
    content = read_bytes(path)
    return _npy(content, path) if path.suffix.lower() == ".npy" else _pillow(content, path, deep)


def _npy(content: bytes, path: Path) -> Image:
    with parsing(path, "NPY file"):
        image = npy_array(content)
    return image.astype(image.dtype.newbyteorder("="))


def _pillow(content: bytes, path: Path, deep: bool) -> Image:
    try:
        from PIL import Image as Pillow
    except ImportError as error:
        raise PrunusError(
            f"{path}: images other than NPY need Pillow; expected pip install 'prunus[fuse]'"
        ) from error
    with parsing(path, "image"), Pillow.open(io.BytesIO(content)) as image:
        if not deep:
            return np.asarray(image if image.mode in GREY else image.convert("RGB"))
        steps = np.asarray(image)
        fits = image.mode in DEEP and steps.size and 0 <= steps.min() <= steps.max() < 2**16
        return steps.astype(np.uint16) if fits else steps


def _kind(image: Image) -> str:
    return f"holds {image.dtype} of the shape {image.shape}"
