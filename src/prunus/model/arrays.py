"""The array types of the model, and the one way arrays are frozen."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from prunus.errors import PrunusError

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]
Bytes = NDArray[np.uint8]

GRID = 2.0**-20
"""Coordinates are held on a grid of about a micrometre (metres). See `snapped`."""


Shape = tuple[int | None, ...]
"""Lengths of an array; None = any."""


def frozen(values: Any, dtype: Any, shape: Shape, name: str = "array") -> NDArray[Any]:
    """A read-only array of that type and shape.

    Lists, tables and tensors will do. Raises PrunusError naming it where it is none, where it holds
    masked values, or others than that type can hold: nothing is rounded, cut off or read from text.
    """
    if np.ma.is_masked(values):
        raise PrunusError(f"{name}: holds masked values; expected an array without a mask")
    try:
        found = np.asarray(values)
    except Exception as error:
        # what another library's object raises here is its own affair: RuntimeError in torch
        raise PrunusError(f"{name}: not an array of numbers: {error}") from error
    if found.shape == (0,) and shape[:1] in ((None,), (0,)):
        found = np.zeros([length or 0 for length in shape], dtype)
    fits = found.ndim == len(shape) and all(
        want is None or want == got for want, got in zip(shape, found.shape, strict=True)
    )
    if not fits:
        raise PrunusError(f"{name}: shape {found.shape}; expected {_shown(shape)}")
    array = _cast(found, np.dtype(dtype), name)
    array.setflags(write=False)
    return array


KINDS = {"f": "numbers", "i": "integers", "u": "integers", "b": "true or false"}
"""What an array of a kind is to hold."""
OTHERS = {"U": "text", "S": "text", "V": "named columns", "O": "objects", "b": "truth values"}
"""What else people give."""


def _cast(found: NDArray[Any], wanted: np.dtype[Any], name: str) -> NDArray[Any]:
    """A copy in another type that holds the same values, but for the last digits of floats."""
    expected = f"expected {KINDS[wanted.kind]}"
    held = {"f": "fiuO", "i": "iu", "u": "iu", "b": "b"}[wanted.kind]
    if found.size and found.dtype.kind not in held:
        raise PrunusError(f"{name}: {OTHERS.get(found.dtype.kind, found.dtype)}; {expected}")
    try:
        array = found.astype(wanted)
    except (TypeError, ValueError, OverflowError) as error:
        raise PrunusError(f"{name}: {error}; {expected}") from error
    if wanted.kind in "iu" and found.dtype != wanted and not np.array_equal(array, found):
        raise PrunusError(f"{name}: holds {found.min()} to {found.max()}; {expected} of {wanted}")
    return array


def _shown(shape: Shape) -> str:
    """A shape as one writes it: (N, 3)."""
    lengths = ["N" if length is None else str(length) for length in shape]
    return f"({', '.join(lengths)}{',' * (len(shape) == 1)})"


def cubes(xyz: Floats, side: float) -> Ints:
    """A number (P,) for the cube of that side, metres, in which each point (P, 3) lies."""
    place = np.floor((xyz - xyz.min(axis=0)) / side).astype(np.int64)
    return np.asarray((place[:, 0] << 42) | (place[:, 1] << 21) | place[:, 2])


def snapped(xyz: Floats) -> Floats:
    """Coordinates rounded to `GRID`.

    On the grid, sums of coordinates are exact, so they do not depend on the order of summation,
    and a moved or half-turned cloud leads to the very same decisions. Halves, which a cloud that
    was on the grid before has about its middle, go outward however the move rounded them.
    """
    return np.asarray(np.copysign(np.floor(np.abs(xyz) / GRID + 0.51), xyz) * GRID)
