"""Which columns of a table are x, y, z and colours: by their names, never by a guess."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from prunus.errors import PrunusError
from prunus.io.clouds.units import unit_called
from prunus.model.arrays import Bytes, Floats

Columns = tuple[Floats, Bytes | None]
"""xyz (P, 3) as in the file, rgb (P, 3) where the file has colours."""

AXES = (
    ("x", "y", "z"),
    ("points:0", "points:1", "points:2"),
    *(tuple(f"{word}_{axis}" for axis in "xyz") for word in ("pos", "position", "point", "coord")),
    *(tuple(f"{axis}_{word}" for axis in "xyz") for word in ("pos", "coord", "coordinate")),
    *(("easting", "northing", height) for height in ("elevation", "height", "altitude", "z")),
)  # fmt: skip
"""Names by which x, y and z go in exports (the second is ParaView's), in small letters."""

COLOURS = (
    ("red", "green", "blue"),
    ("r", "g", "b"),
    ("rf", "gf", "bf"),
    ("diffuse_red", "diffuse_green", "diffuse_blue"),
    ("rgb:0", "rgb:1", "rgb:2"),
    ("colors:0", "colors:1", "colors:2"),
)
"""Names by which red, green and blue go (the third are CloudCompare's as shares of one)."""

DARKEST = 32
"""Some point of a cloud with colours is as bright, of 255."""

LATEST = 1e8
"""A first number beyond is no coordinate of a survey, but a time."""

BRACKETED = re.compile(r"\s*[\[(]\s*([^\])]*?)\s*[\])]$")
"""A unit behind a name: `x[m]`, `Y (mm)`."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Content:
    """What a file holds: xyz (P, 3) in its own unit, rgb (P, 3) or None, and what it says of both.

    `metres`: how many are in one unit, where the file tells; `sure`: its kind has a place for that;
    `fault`: why its coordinates are none in any unit of length, where it says so.
    """

    xyz: Floats
    rgb: Bytes | None = None
    metres: float | None = None
    notes: list[str] = field(default_factory=list)
    fault: str = ""
    sure: bool = False


def columns_of(table: Any, names: Sequence[str], path: Path | str) -> Columns:
    """x, y, z and colours among the named columns of a table; PrunusError where one is missing."""
    axes = axes_among(names, path)
    xyz = np.empty((len(table[names[axes[0]]]), 3))
    for axis, column in enumerate(axes):
        values = np.asarray(table[names[column]])
        if values.ndim != 1 or values.dtype.kind not in "fiu":
            raise PrunusError(f"{path}: {names[column]!r} holds no numbers; expected one a point")
        xyz[:, axis] = values
    colours = colours_among(names)
    if colours is None:
        return xyz, None
    return xyz, colour_bytes(np.column_stack([table[names[column]] for column in colours]))


def content_of(table: Any, names: Sequence[str], path: Path) -> Content:
    """What named columns hold, with the unit behind their names; see `columns_of`."""
    xyz, rgb = columns_of(table, names, path)
    colours, notes = colours_among(names), list[str]()
    if colours is not None and rgb is None:
        notes.append(f"no colours: {', '.join(names[k] for k in colours)} hold something else")
    return Content(
        xyz=xyz, rgb=rgb, metres=unit_among(names, axes_among(names, path), path), notes=notes
    )


def axes_among(names: Sequence[str], path: Path | str) -> list[int]:
    """Which of the names are x, y, z; PrunusError where they are not all there, or are there twice.

    Capitals, quotes and units behind a name (`X [m]`) do not matter.
    """
    plain = [_plain(name) for name in names]
    for family in AXES:
        if all(name in plain for name in family):
            double = [name for name in family if plain.count(name) > 1]
            if double:
                raise PrunusError(f"{path}: {double[0]!r} stands twice among {_list(names)}")
            return [plain.index(name) for name in family]
    missing = next((axis for axis in "xyz" if axis not in plain), "x")
    raise PrunusError(
        f"{path}: no column {missing!r} among {_list(names)}; expected x, y, z "
        "(or names as in docs/inputs.md)"
    )


def are_axes(names: Sequence[str]) -> bool:
    """Whether x, y and z are among the names."""
    plain = {_plain(name) for name in names}
    return any(plain.issuperset(family) for family in AXES)


def colours_among(names: Sequence[str]) -> list[int] | None:
    """Which of the names are red, green, blue; None where they are not."""
    plain = [_plain(name) for name in names]
    for family in COLOURS:
        if all(plain.count(name) == 1 for name in family):
            return [plain.index(name) for name in family]
    return None


def unit_among(names: Sequence[str], axes: Sequence[int], path: Path | str) -> float | None:
    """Metres in the unit that stands behind the names of x, y, z, if any does.

    PrunusError where they name several, or one that is unknown.
    """
    told = {match[1] if (match := BRACKETED.search(names[k].strip(" \"'"))) else "" for k in axes}
    if told == {""}:
        return None
    metres = unit_called(told.pop()) if len(told) == 1 else None
    if metres is None:
        raise PrunusError(
            f"{path}: no one unit behind {', '.join(names[k] for k in axes)}; "
            "expected [m], [cm], [mm], [ft], [us-ft] or [in] behind all three, or none"
        )
    return metres


def _plain(name: str) -> str:
    return BRACKETED.sub("", name.strip(" \t\"'").lower())


def _list(names: Sequence[str]) -> str:
    return ", ".join(names) or "none"


def colour_bytes(rgb: Any) -> Bytes | None:
    """Colours (P, 3) as bytes, whether they came as bytes, 16-bit numbers or shares of one.

    None where the numbers are none of these.
    """
    if rgb.dtype == np.uint8:
        return np.asarray(rgb)
    if rgb.dtype.kind not in "fiu":
        return None
    values = np.nan_to_num(np.asarray(rgb, np.float64))
    low, high = (values.min(), values.max()) if values.size else (0, 0)
    if low < 0 or high > 65_535:
        return None
    if high > 255:
        return (values / 256).astype(np.uint8)
    share = rgb.dtype.kind == "f" and high <= 1
    return (values * 255 if share else values).astype(np.uint8)


def check_first(rows: Floats, path: Path) -> None:
    """That the first of columns (P, C) without names is no number of the point, and no time.

    PrunusError where it counts on among fractions, or is larger than any coordinate of a survey.
    """
    real = rows[np.isfinite(rows[:, :3]).all(axis=1)]
    steps, whole = np.diff(real[:, 0]), (real[:, :3] == np.floor(real[:, :3])).all(axis=0)
    counts = len(real) > 2 and bool((steps > 0).all() and whole[0] and not whole[1:].any())
    if counts or np.abs(real[:, 0]).max(initial=0) > LATEST:
        what = "counts the points" if counts else f"holds {real[0, 0]:.10g}, as times are"
        raise PrunusError(
            f"{path}: the first of {rows.shape[1]} columns {what}; expected x, y, z first, or the "
            "names of all columns"
        )


def are_colours(values: Floats) -> bool:
    """Whether unnamed numbers (P, 3) are plausibly colours: whole, from 0 to 255, not all small.

    Classes and numbers of returns are small.
    """
    whole = (values >= 0) & (values <= 255) & (values == np.floor(values))
    return bool(whole.all() and values.max(initial=0) >= DARKEST)


def unpacked(packed: Any) -> Bytes:
    """Colours (P, 3) from numbers (P,) of four bytes each, that hold red, green and blue.

    A float is those bytes, which are next to nothing or no number; one from 1 up is the value.
    """
    if packed.dtype.kind == "f":
        numbers = np.nan_to_num(packed.astype(np.float64), nan=0.0, posinf=0.0)
        packed = numbers if (numbers >= 1).any() else packed.astype(np.float32).view(np.uint32)
    bits = np.clip(packed, 0, 2**32 - 1).astype(np.uint32)
    return np.column_stack([bits >> 16, bits >> 8, bits]).astype(np.uint8)
