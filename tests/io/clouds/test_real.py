"""Points that are none are left out and said, in files of every kind; so are steps of precision."""

from pathlib import Path

import laspy
import numpy as np
import pytest

from prunus.errors import PrunusError
from prunus.io.clouds.cloud_file import FileCloud, read_cloud
from prunus.io.ply import ply_bytes, table_of

XYZ = np.random.default_rng(0).uniform(-1, 1, (600, 3)) * [0.6, 0.3, 1.5] + [0, 0, 1.5]
UTM = np.array([543_210.0, 5_712_345.0, 250.0])


def write(path: Path, xyz: np.ndarray) -> Path:
    """A cloud as it is, its numbers of the type that they have."""
    table = table_of(dict(zip("xyz", xyz.T, strict=True)))
    ending = path.suffix
    if ending == ".ply":
        path.write_bytes(ply_bytes({"vertex": table}, []))
    elif ending == ".pcd":
        size, points = xyz.dtype.itemsize, len(xyz)
        head = f"FIELDS x y z\nSIZE {size} {size} {size}\nTYPE F F F\nWIDTH {points}\nDATA binary\n"
        path.write_bytes(head.encode() + np.ascontiguousarray(xyz).tobytes())
    elif ending == ".npy":
        np.save(path, xyz)
    elif ending == ".npz":
        np.savez(path, xyz=xyz)
    elif ending == ".las":
        header = laspy.LasHeader(point_format=0)
        header.scales, header.offsets = np.full(3, 1e-4), np.floor(xyz.mean(axis=0))
        las = laspy.LasData(header)
        las.x, las.y, las.z = xyz.T
        las.write(path)
    else:
        np.savetxt(path, xyz, "%.9g" if xyz.dtype == np.float32 else "%.12g")
    return path


KINDS = [".ply", ".pcd", ".npy", ".npz", ".xyz", ".txt", ".csv", ".asc", ".pts"]


@pytest.mark.parametrize("ending", KINDS)
@pytest.mark.parametrize("wrong", [np.nan, np.inf, -np.inf, 3.4028235e38])
def test_points_that_are_not_finite_are_left_out(tmp_path: Path, ending: str, wrong: float) -> None:
    xyz = XYZ.copy()
    xyz[5:9, 1], xyz[20] = wrong, wrong
    cloud = read_cloud(write(tmp_path / f"a{ending}", xyz))
    assert cloud.xyz == pytest.approx(np.delete(XYZ, [5, 6, 7, 8, 20], axis=0), abs=1e-9)
    assert cloud.notes == ["5 of 600 points are not finite (NaN) and were left out"]


@pytest.mark.parametrize("ending", [*KINDS, ".las"])
def test_points_at_the_origin_in_bulk_are_left_out(tmp_path: Path, ending: str) -> None:
    xyz = XYZ.copy()
    xyz[40:90] = 0
    cloud = read_cloud(write(tmp_path / f"a{ending}", xyz))
    assert cloud.xyz == pytest.approx(np.delete(XYZ, range(40, 90), axis=0), abs=1e-4)
    assert cloud.notes == ["50 of 600 points lie exactly at the origin and were left out"]


def test_one_point_at_the_origin_is_a_point(tmp_path: Path) -> None:
    xyz = XYZ.copy()
    xyz[7] = 0
    cloud = read_cloud(write(tmp_path / "a.npy", xyz))
    assert (cloud.xyz == xyz).all() and cloud.notes == []


def test_colours_go_with_their_points(tmp_path: Path) -> None:
    rgb = (np.arange(1800) % 251).astype(np.uint8).reshape(-1, 3)
    xyz = XYZ.copy()
    xyz[::7, 2] = np.nan
    np.savez(tmp_path / "a.npz", xyz=xyz, rgb=rgb)
    cloud = read_cloud(tmp_path / "a.npz")
    assert cloud.rgb is not None and (cloud.rgb == rgb[np.isfinite(xyz).all(axis=1)]).all()


@pytest.mark.parametrize(
    "xyz",
    [
        np.full((9, 3), np.nan), np.zeros((9, 3)), np.full((9, 3), 1e38),
        np.vstack([np.full((5000, 3), np.nan), XYZ[:3]]),
    ],
)  # fmt: skip
def test_a_cloud_with_hardly_a_point_is_refused(tmp_path: Path, xyz: np.ndarray) -> None:
    with pytest.raises(PrunusError, match=r"a\.npy: only [03] of (9|5003) points are any"):
        read_cloud(write(tmp_path / "a.npy", xyz))


@pytest.mark.parametrize("ending", [*KINDS, ".las"])
def test_large_coordinates_in_single_precision_are_refused(tmp_path: Path, ending: str) -> None:
    single = (XYZ + UTM).astype(np.float32)
    path = write(tmp_path / f"a{ending}", single)
    with pytest.raises(PrunusError, match=r"in steps of 0\.5 m: single precision"):
        read_cloud(path)
    again = single.astype(np.float64)
    with pytest.raises(PrunusError, match=r"in steps of 0\.5 m: single precision"):
        read_cloud(write(tmp_path / f"b{ending}", again))


@pytest.mark.parametrize("ending", [*KINDS, ".las"])
def test_large_coordinates_in_double_precision_are_fine(tmp_path: Path, ending: str) -> None:
    cloud = read_cloud(write(tmp_path / f"a{ending}", XYZ + UTM))
    assert cloud.xyz == pytest.approx(XYZ + UTM, abs=6e-5, rel=0) and cloud.notes == []


def noted(tmp_path: Path, xyz: np.ndarray, unit: str | None = None) -> FileCloud | str:
    try:
        return read_cloud(write(tmp_path / "a.npy", xyz), unit)
    except PrunusError as error:
        return str(error)


@pytest.mark.parametrize(
    ("far", "step"),
    [(600_000, "0.0625"), (5_000_000, "0.5"), (200_000, "0.0156"), (2_000_000, "0.125")],
)
@pytest.mark.parametrize("digits", [3, 9])
def test_the_step_is_named_also_of_rounded_text(
    tmp_path: Path, far: float, step: str, digits: int
) -> None:
    said = noted(
        tmp_path, np.round((XYZ + np.array([far, 0, 0])).astype(np.float32).astype(float), digits)
    )
    assert isinstance(said, str) and f"in steps of {step} m: single precision" in said


@pytest.mark.parametrize(("far", "step"), [(30_000, "0.00195"), (100_000, "0.00781")])
def test_small_steps_are_noted(tmp_path: Path, far: float, step: str) -> None:
    cloud = noted(tmp_path, (XYZ + np.array([0, far, 0])).astype(np.float32))
    assert isinstance(cloud, FileCloud)
    assert cloud.notes == [f"the coordinates come in steps of {step} m: single precision"]


@pytest.mark.parametrize(
    "xyz",
    [
        XYZ.astype(np.float32),
        (XYZ + 5000).astype(np.float32),
        np.round(XYZ, 3),
        XYZ * [1, 1, 0],
        XYZ * [0.03, 0.02, 1],
        XYZ * [0.03, 1, 0.002] + [0, 0, 12],
    ],
)
def test_fine_coordinates_have_no_note(tmp_path: Path, xyz: np.ndarray) -> None:
    cloud = noted(tmp_path, xyz)
    assert isinstance(cloud, FileCloud) and cloud.notes == []


@pytest.mark.parametrize(
    ("xyz", "step"),
    [
        (np.round(XYZ + UTM, 2), "0.01"),
        (np.round(XYZ, 1), "0.1"),
        (np.round(XYZ / 0.04) * 0.04 + 0.017, "0.04"),
    ],
)
def test_few_digits_are_said_to_be_that(tmp_path: Path, xyz: np.ndarray, step: str) -> None:
    cloud = noted(tmp_path, xyz)
    assert isinstance(cloud, FileCloud)
    assert cloud.notes == [
        f"the coordinates come in steps of {step} m: they were rounded, or are written with few "
        "digits"
    ]


def test_whole_millimetres_are_fine(tmp_path: Path) -> None:
    cloud = noted(tmp_path, np.round(XYZ * 1000), "mm")
    assert isinstance(cloud, FileCloud) and len(cloud.notes) == 1 and "unit mm" in cloud.notes[0]
