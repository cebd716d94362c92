"""Which points of a cloud are any, and how finely their coordinates are told."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from prunus.errors import PrunusError
from prunus.io.clouds.columns import Content
from prunus.model.arrays import Floats
from prunus.model.steps import step_of

BULK = 3
"""So many points exactly at the origin are what sensors write where they saw nothing."""
FARTHEST = 1e11
"""Coordinates beyond, in any unit, are what sensors write for infinity (3.4e38)."""
HARDLY = 1e-3
"""A cloud with a smaller share of real points is none."""

NOTED_STEP_M = 0.001
"""Larger steps between coordinates are said."""
SPOILED_STEP_M = 0.01
"""Larger steps of single precision are refused: twigs of one become rows of points."""


def only_real(found: Content, path: Path) -> Content:
    """The points that are some: finite, and not at the origin in bulk; notes on what was left out.

    PrunusError where none or hardly any is left.
    """
    xyz, rgb, notes = found.xyz, found.rgb, list(found.notes)
    if len(xyz) == 0:
        raise PrunusError(f"{path}: holds no points; expected at least one")
    finite = (np.abs(xyz) < FARTHEST).all(axis=1)
    nowhere = (xyz == 0).all(axis=1)
    if nowhere.sum() < BULK:
        nowhere[:] = False
    kept = finite & ~nowhere
    if kept.sum() < max(1, HARDLY * len(xyz)):
        raise PrunusError(
            f"{path}: only {kept.sum()} of {len(xyz)} points are any: {(~finite).sum()} are not "
            f"finite, {nowhere.sum()} lie at the origin; expected a cloud"
        )
    if kept.all():
        return found
    for left_out, why in (
        (~finite, "are not finite (NaN)"),
        (nowhere, "lie exactly at the origin"),
    ):
        if left_out.any():
            notes.append(f"{left_out.sum()} of {len(xyz)} points {why} and were left out")
    colours = None if rgb is None else rgb[kept]
    return replace(found, xyz=xyz[kept], rgb=colours, notes=notes)


def check_steps(xyz: Floats, metres: float, path: Path) -> list[str]:
    """Notes on points (P, 3) whose coordinates come in steps; `metres` in one unit of them.

    PrunusError where single precision could not hold them: its steps grow with the distance from
    the origin, to half a metre in the northings of UTM, whatever the file says they are now.
    """
    step, single = max(map(step_of, xyz.T), default=(0.0, False))
    size = step * metres
    if size <= NOTED_STEP_M * 1.001:
        return []
    text = f"the coordinates come in steps of {size:.3g} m"
    if not single:
        return [f"{text}: they were rounded, or are written with few digits"]
    if size <= SPOILED_STEP_M:
        return [f"{text}: single precision"]
    raise PrunusError(
        f"{path}: {text}: single precision cannot hold numbers as large as "
        f"{np.abs(xyz).max():.0f}; expected double precision, or coordinates from a nearer origin"
    )
