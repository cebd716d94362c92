"""The settings of a simulated scan: `field` and `clean`, read from a documented TOML file."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Literal

from prunus.reading import read_toml
from prunus.simulate.habits import Group, Range

Setting = Literal["field", "clean"]


class RowSettings(Group):
    """What stands around the target: metres, degrees, shares."""

    towards: float
    lean: Range
    lean_varies: Range
    spacing: Range
    alike: float
    room: Range
    behind: float
    behind_depth: Range
    shift: Range
    wires: Range
    first_wire: Range
    wire_radius: Range
    wire_sag: Range
    tied: float
    post: float
    post_radius: Range
    ground_rough: float
    tufts: Range
    blade: Range
    bare: Range
    buried: Range


class RigSettings(Group):
    """Two cameras, one above the other, at three stops of a slide: metres, degrees, pixels."""

    width: int
    height: int
    view: float
    baseline: float
    near: float
    far: Range
    distance: Range
    low: Range
    between: Range
    tilt: Range
    stops: Range
    aim: Range
    turned: float
    moved: float


class StereoSettings(Group):
    """The faults of stereo matching: pixels, metres, shares."""

    voxel: float
    reach: Range
    subpixel: float
    block: int
    block_share: float
    step: float
    flying: float
    thin: float
    patch: float
    patchy: float
    flicker: float
    stray: float
    ground: float


class ScanSettings(Group):
    """How an orchard row is scanned; see `scan.toml`."""

    row: RowSettings
    rig: RigSettings
    stereo: StereoSettings


@cache
def scan_settings(name: Setting = "field") -> ScanSettings:
    """The settings of that name."""
    path = Path(__file__).with_name("scan.toml")
    return ScanSettings.model_validate(read_toml(path)[name])
