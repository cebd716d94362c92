"""The settings of simulated scans: the paper's own orchard, a hard one, and clean scans of that.

`hard` is `habits.toml` and `scan.toml`; `clean` the same trees, hardly disturbed (`scan.toml`);
`ordinary` what `ordinary.toml` changes of `hard`.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any, Literal

from prunus.files.reading import read_toml
from prunus.lab.simulate.habits import Group, Habits, Range, ufo_habits

Setting = Literal["ordinary", "hard", "clean", "field"]
"""`field` is an older name of `hard`."""


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
def scan_settings(name: Setting = "hard") -> ScanSettings:
    """How the rows of that setting are scanned."""
    settings = _read("scan.toml")
    if name == "ordinary":
        return ScanSettings.model_validate(
            _changed(settings["hard"], _read("ordinary.toml")["scan"])
        )
    return ScanSettings.model_validate(settings["hard" if name == "field" else name])


@cache
def habits_in(name: Setting = "hard") -> Habits:
    """The habits of the trees of that setting."""
    if name != "ordinary":
        return ufo_habits()
    changes = _read("ordinary.toml")["habits"]
    return Habits.model_validate(_changed(ufo_habits().model_dump(), changes))


def _read(name: str) -> dict[str, Any]:
    return read_toml(Path(__file__).with_name(name))


def _changed(groups: dict[str, Any], changes: dict[str, Any]) -> dict[str, Any]:
    return groups | {name: groups[name] | values for name, values in changes.items()}
