"""The array types of the model, and the one way arrays are frozen."""

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]
Bytes = NDArray[np.uint8]

GRID = 2.0**-20
"""Coordinates are held on a grid of about a micrometre (metres). See `snapped`."""


def frozen(values: ArrayLike, dtype: Any, shape: tuple[int | None, ...]) -> NDArray[Any]:
    """A read-only array of that type and shape (None = any length); ValueError otherwise."""
    array = np.array(values, dtype=dtype)
    fits = array.ndim == len(shape) and all(
        want is None or want == got for want, got in zip(shape, array.shape, strict=False)
    )
    if not fits:
        raise ValueError(f"expected an array of shape {shape}, found {array.shape}")
    array.setflags(write=False)
    return array


def cubes(xyz: Floats, side: float) -> Ints:
    """A number (P,) for the cube of that side, metres, in which each point (P, 3) lies."""
    place = np.floor((xyz - xyz.min(axis=0)) / side).astype(np.int64)
    return np.asarray((place[:, 0] << 42) | (place[:, 1] << 21) | place[:, 2])


def cells(xyz: Floats, side: float, apart: int = 1) -> Ints:
    """A number (P,) for the cube about a multiple of that side, metres, in which each point lies.

    Cubes lie alike on both sides of the origin: half a turn about Z changes none. Numbers are
    multiples of `apart`. Where they would be too large the cubes are larger.
    """
    place = np.rint(xyz / side).astype(np.int64)
    place -= place.min(axis=0)
    span = [int(most) + 1 for most in place.max(axis=0)]
    if math.prod(span) * apart >= 2**63:
        return cells(xyz, 2 * side, apart)
    return np.asarray(((place[:, 0] * span[1] + place[:, 1]) * span[2] + place[:, 2]) * apart)


def snapped(xyz: Floats) -> Floats:
    """Coordinates rounded to `GRID`.

    On the grid, sums of coordinates are exact, so they do not depend on the order of summation,
    and a moved or half-turned cloud leads to the very same decisions. Halves, which a cloud that
    was on the grid before has about its middle, go outward however the move rounded them.
    """
    return np.asarray(np.copysign(np.floor(np.abs(xyz) / GRID + 0.51), xyz) * GRID)
