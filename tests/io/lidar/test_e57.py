"""E57: all scans of a file where their poses put them, in metres, without points that are none."""

import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from prunus.errors import PrunusError
from prunus.io.clouds.cloud_file import read_cloud

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


@pytest.mark.parametrize("name", [b"\xe4pfel.e57", b"a#1?.e57", "\u6a39 \u00e4.e57".encode()])
def test_any_name_will_do(tmp_path: Path, name: bytes) -> None:
    made = write(tmp_path / "a.e57", columns(XYZ))
    path = made.rename(tmp_path / os.fsdecode(name))
    assert read_cloud(path).xyz == pytest.approx(XYZ)


def test_without_pye57_it_says_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "a.e57").write_bytes(b"x")
    monkeypatch.setitem(__import__("sys").modules, "pye57", None)
    with pytest.raises(PrunusError, match=r"a\.e57: .*pip install 'prunus\[e57\]'"):
        read_cloud(tmp_path / "a.e57")


def spherical(path: Path, columns: dict[str, np.ndarray], brightest: int | None = None) -> Path:
    """An E57 of one scan without a pose, each column a field of doubles."""
    from pye57 import libe57

    with pye57.E57(str(path), mode="w") as file:
        image = file.image_file
        scan, prototype = libe57.StructureNode(image), libe57.StructureNode(image)
        if brightest is not None:
            limits = libe57.StructureNode(image)
            limits.set("colorRedMaximum", libe57.IntegerNode(image, brightest))
            scan.set("colorLimits", limits)
        buffers = libe57.VectorSourceDestBuffer()
        for name, values in columns.items():
            prototype.set(name, libe57.FloatNode(image, 0.0, libe57.E57_DOUBLE, -1e9, 1e9))
            buffers.append(libe57.SourceDestBuffer(image, name, values, len(values), True, True))
        codecs = libe57.VectorNode(image, True)
        points = libe57.CompressedVectorNode(image, prototype, codecs)
        scan.set("points", points)
        file.data3d.append(scan)
        writer = points.writer(buffers)
        writer.write(len(values))
        writer.close()
    return path


def test_spherical_coordinates_are_turned_into_cartesian_ones(tmp_path: Path) -> None:
    far = np.linalg.norm(XYZ, axis=1)
    columns = {
        "sphericalRange": far,
        "sphericalAzimuth": np.arctan2(XYZ[:, 1], XYZ[:, 0]),
        "sphericalElevation": np.arcsin(XYZ[:, 2] / far),
    }
    cloud = read_cloud(spherical(tmp_path / "a.e57", columns))
    assert cloud.xyz == pytest.approx(XYZ, abs=1e-12)


@pytest.mark.parametrize(("brightest", "taken"), [(255, True), (65535, False), (None, True)])
def test_colours_that_are_no_bytes_are_not_taken(
    tmp_path: Path, brightest: int | None, taken: bool
) -> None:
    held = columns(XYZ.copy()) | {f"color{c}": np.full(60, 7.0) for c in ("Red", "Green", "Blue")}
    held = {name: np.ascontiguousarray(values) for name, values in held.items()}
    cloud = read_cloud(spherical(tmp_path / "a.e57", held, brightest))
    assert cloud.xyz == pytest.approx(XYZ, abs=1e-12)
    assert (cloud.rgb is not None) == taken
    assert cloud.notes == ([] if taken else ["no colours: they are no bytes"])


def test_a_scan_of_something_else_is_refused(tmp_path: Path) -> None:
    with pytest.raises(PrunusError, match=r"a\.e57: a scan of intensity; expected cartesianX"):
        read_cloud(spherical(tmp_path / "a.e57", {"intensity": np.ones(9)}))
