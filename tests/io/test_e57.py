"""E57: all scans of a file where their poses put them, in metres, without points that are none."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from prunus.errors import PrunusError
from prunus.io.clouds import read_cloud

pye57 = pytest.importorskip("pye57")

XYZ = np.random.default_rng(0).uniform(-1, 1, (60, 3)).astype(np.float32).astype(np.float64)
"""As pye57 writes them: in single precision."""
RGB = np.random.default_rng(1).integers(0, 256, (60, 3)).astype(np.uint8)
QUARTER = np.array([np.sqrt(0.5), 0, 0, np.sqrt(0.5)])
"""A quarter turn about Z, w first: x becomes y."""


def columns(xyz: np.ndarray, rgb: np.ndarray | None = None) -> dict[str, Any]:
    held = {f"cartesian{axis}": xyz[:, k] for k, axis in enumerate("XYZ")}
    if rgb is not None:
        held |= {f"color{name}": rgb[:, k] for k, name in enumerate(("Red", "Green", "Blue"))}
    return held


def write(path: Path, *scans: dict[str, Any]) -> Path:
    with pye57.E57(str(path), mode="w") as file:
        for scan in scans:
            pose = {key: scan.pop(key) for key in ("rotation", "translation") if key in scan}
            file.write_scan_raw(scan, **pose)
    return path


def test_points_and_colours_come_back(tmp_path: Path) -> None:
    cloud = read_cloud(write(tmp_path / "a.e57", columns(XYZ, RGB)))
    assert cloud.xyz == pytest.approx(XYZ, abs=1e-12)
    assert cloud.rgb is not None and (cloud.rgb == RGB).all() and cloud.notes == []


def test_scans_are_joined_by_their_poses(tmp_path: Path) -> None:
    moved = columns(XYZ) | {"rotation": QUARTER, "translation": np.array([10.0, 0, 1])}
    cloud = read_cloud(write(tmp_path / "a.e57", columns(XYZ[:9], RGB[:9]), moved))
    there = np.column_stack([10 - XYZ[:, 1], XYZ[:, 0], 1 + XYZ[:, 2]])
    assert cloud.xyz == pytest.approx(np.concatenate([XYZ[:9], there]), abs=1e-12)
    assert cloud.rgb is None and cloud.notes == ["2 scans joined by their poses"]


def test_invalid_points_are_left_out(tmp_path: Path) -> None:
    state = np.array([0, 1, 2] * 20, np.int8)
    scan = columns(np.where(state[:, None] > 0, 0, XYZ)) | {"cartesianInvalidState": state}
    cloud = read_cloud(write(tmp_path / "a.e57", scan))
    assert cloud.xyz == pytest.approx(XYZ[::3], abs=1e-12)
    assert cloud.notes == ["40 of 60 points are marked as invalid and left out"]


def test_the_unit_is_the_metre_whatever_the_width(tmp_path: Path) -> None:
    path = write(tmp_path / "a.e57", columns(XYZ * 200))
    assert read_cloud(path).xyz == pytest.approx(XYZ * 200)
    cloud = read_cloud(path, "ft")
    assert cloud.xyz == pytest.approx(XYZ * 200 * 0.3048)
    assert cloud.notes == ["unit ft as asked, but the header tells m"]


@pytest.mark.parametrize("share", [0.0, 0.2, 0.5, 0.9, 0.99])
def test_a_truncated_file_is_refused(tmp_path: Path, share: float) -> None:
    content = write(tmp_path / "a.e57", columns(XYZ)).read_bytes()
    (tmp_path / "cut.e57").write_bytes(content[: max(9, int(share * len(content)))])
    with pytest.raises(PrunusError, match=r"cut\.e57: not a readable E57 file: .") as error:
        read_cloud(tmp_path / "cut.e57")
    assert "\n" not in str(error.value)


def test_without_pye57_it_says_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "a.e57").write_bytes(b"x")
    monkeypatch.setitem(__import__("sys").modules, "pye57", None)
    with pytest.raises(PrunusError, match=r"a\.e57: .*pip install 'prunus\[e57\]'"):
        read_cloud(tmp_path / "a.e57")
