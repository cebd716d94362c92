"""Arrays of numpy: P points or a refusal, whatever their layout; never larger than their file."""

import io
import struct
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from prunus.errors import PrunusError
from prunus.io.clouds.cloud_file import read_cloud
from prunus.io.clouds.numpyfiles import npy_array

XYZ = np.random.default_rng(0).uniform(-1, 1, (12, 3))
HALF = XYZ.astype(np.float16)


def table(order: str = "<", shape: tuple[int, ...] = (12,)) -> np.ndarray:
    held = np.zeros(
        shape, [("i", "u1"), ("Z", order + "f8"), ("Y", order + "f8"), ("X", order + "f8")]
    )
    for k, axis in enumerate("XYZ"):
        held[axis] = XYZ[:, k].reshape(shape)
    return held


@pytest.mark.parametrize(
    "array",
    [
        XYZ,
        np.asfortranarray(XYZ),
        XYZ.astype(">f8"),
        XYZ.reshape(3, 4, 3),
        np.hstack([XYZ, XYZ]),
        np.asfortranarray(XYZ.reshape(4, 3, 3)),
        table(),
        table(">"),
        table("<", (3, 4)),
        XYZ[::-1][::-1],
    ],
)
def test_any_layout_gives_the_points(tmp_path: Path, array: np.ndarray) -> None:
    np.save(tmp_path / "a.npy", array)
    assert (read_cloud(tmp_path / "a.npy").xyz == XYZ).all()
    np.savez_compressed(tmp_path / "a.npz", Points=array)
    assert (read_cloud(tmp_path / "a.npz").xyz == XYZ).all()


@pytest.mark.parametrize("kind", ["f2", "f4", ">f4", "i2", "u1"])
def test_any_kind_of_number_is_one(tmp_path: Path, kind: str) -> None:
    array = (HALF if kind == "f2" else np.arange(36).reshape(12, 3)).astype(kind)
    np.save(tmp_path / "a.npy", array)
    assert (read_cloud(tmp_path / "a.npy").xyz == array.astype(float)).all()


@pytest.mark.parametrize("version", [(1, 0), (2, 0), (3, 0)])
def test_every_version_of_the_format(version: tuple[int, int]) -> None:
    out = io.BytesIO()
    np.lib.format.write_array(out, XYZ, version)
    assert (npy_array(out.getvalue()) == XYZ).all()


def test_long_integers_of_python_2() -> None:
    assert (npy_array(npy("(12L, 3L)") + XYZ.tobytes()) == XYZ).all()


def npy(shape: str, descr: str = "'<f8'") -> bytes:
    head = f"{{'descr': {descr}, 'fortran_order': False, 'shape': {shape}, }}\n".encode()
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head


@pytest.mark.parametrize(
    ("array", "said"),
    [
        (XYZ.T, r"shape \(3, 12\): points across"),
        (XYZ.T[:2], r"shape \(2, 12\): points across"),
        (np.moveaxis(XYZ.reshape(3, 4, 3), 2, 0), "points across|expected numbers"),
        (XYZ[:, :2], r"shape \(12, 2\); expected numbers"),
        (XYZ.ravel(), r"shape \(36,\)"),
        (XYZ.astype(complex), "complex128"),
        (XYZ > 0, "bool"),
        (XYZ.astype(str), "<U"),
        (np.zeros(12, [("X", "f8"), ("Y", "f8")]), "no column 'z' among X, Y"),
        (np.zeros(12, [("xyz", "f8", 3)]), "no column 'x' among xyz"),
        (np.zeros(12, [("x", "f8", 3), ("y", "f8"), ("z", "f8")]), "'x' holds no numbers"),
        (np.zeros(12, [("x", "U3"), ("y", "f8"), ("z", "f8")]), "'x' holds no numbers"),
        (np.zeros((0, 3)), "holds no points"),
        (np.float64(3), r"shape \(\)"),
        (np.column_stack([np.arange(12), XYZ]), "first of 4 columns counts the points"),
        (np.column_stack([1.7e9 + XYZ[:, 0], XYZ]), "first of 4 columns holds 1[67]"),
    ],
)
def test_what_is_no_cloud_is_refused(tmp_path: Path, array: np.ndarray, said: str) -> None:
    np.save(tmp_path / "a.npy", array)
    with pytest.raises(PrunusError, match=rf"a\.npy: .*({said})"):
        read_cloud(tmp_path / "a.npy")


def test_three_points_of_three_numbers_are_said_to_be_rows(tmp_path: Path) -> None:
    np.save(tmp_path / "a.npy", XYZ[:3])
    assert read_cloud(tmp_path / "a.npy").notes == ["3 x 3 numbers: each row is read as a point"]


@pytest.mark.parametrize(
    "content",
    [
        npy("(400000000000, 3)") + bytes(64),
        npy("(2**62, 3)") + bytes(64),
        npy("(-1, 3)") + bytes(64),
        npy("(3, 3 ") + bytes(72),
        npy("12") + bytes(96),
        npy("(1.5, 3)") + bytes(96),
        npy("(3, 3)") + bytes(71),
        npy("(4, 3)", "'|O'") + bytes(96),
        npy("(4, 3)", "'nonsense'") + bytes(96),
        npy("(4, 3)").replace(b"shape", b"shade") + bytes(96),
        npy("(4, 3)").replace(b"fortran_order", b"fortran_ordef") + bytes(96),
        npy("(4, 3)")[:20],
        npy("((((") * 3,
        b"\x93NUMPY\x01\x00",
        b"\x93NUMPY\x09\x09" + b"\xff" * 90,
        b"NUMPY",
        npy("(" * 5000) + bytes(9),
    ],
)
def test_a_damaged_header_is_one_line(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "a.npy").write_bytes(content)
    with pytest.raises(PrunusError, match=r"a\.npy: not a (readable )?numpy file: .") as error:
        read_cloud(tmp_path / "a.npy")
    assert "\n" not in str(error.value) and not isinstance(error.value.__cause__, KeyError)


def archive(**arrays: Any) -> bytes:
    out = io.BytesIO()
    np.savez_compressed(out, **arrays)
    return out.getvalue()


def test_a_damaged_archive_is_one_line(tmp_path: Path) -> None:
    good = archive(xyz=np.random.default_rng(1).uniform(0, 1, (3000, 3)))
    torn = good[:400] + b"\xff" * 30 + good[430:]
    swapped = good.replace(b"xyz.npy", b"xyz.npz")
    for content in (torn, good[:-200], good[: len(good) // 2], b"PK" + bytes(90), swapped[:500]):
        (tmp_path / "a.npz").write_bytes(content)
        with pytest.raises(PrunusError, match=r"a\.npz: ") as error:
            read_cloud(tmp_path / "a.npz")
        assert "\n" not in str(error.value)


def test_what_would_unpack_to_too_much_is_refused_before_it_is(tmp_path: Path) -> None:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as held:
        held.writestr("xyz.npy", npy("(4, 3)") + bytes(96))
    content = bytearray(out.getvalue())
    at = content.rindex(b"PK\x01\x02") + 24  # the unpacked size in the directory
    content[at : at + 4] = (2**32 - 2).to_bytes(4, "little")
    (tmp_path / "a.npz").write_bytes(content)
    with pytest.raises(PrunusError, match=r"a\.npz: "):
        read_cloud(tmp_path / "a.npz")


@pytest.mark.parametrize(
    ("arrays", "said"),
    [
        ({"a": XYZ, "b": XYZ}, "holds a, b; expected an array 'xyz'"),
        ({"xyz": XYZ, "rgb": XYZ[:5]}, r"rgb has shape \(5, 3\); expected \(12, 3\)"),
        ({"xyz": XYZ, "rgb": XYZ[:, 0]}, r"rgb has shape \(12,\)"),
        ({"xyz": XYZ.T}, "points across"),
    ],
)
def test_an_archive_of_something_else_is_refused(
    tmp_path: Path, arrays: dict[str, Any], said: str
) -> None:
    (tmp_path / "a.npz").write_bytes(archive(**arrays))
    with pytest.raises(PrunusError, match=rf"a\.npz: .*{said}"):
        read_cloud(tmp_path / "a.npz")


@pytest.mark.parametrize(
    ("rgb", "taken"),
    [
        (np.full((12, 3), 7, np.uint8), 7),
        (np.full((12, 4), 7, np.uint8), 7),
        (np.full((3, 4, 3), 7 * 256, np.uint16), 7),
        (np.full((12, 3), 0.5), 127),
        (np.full((12, 3), 7.0), 7),
        (np.full((12, 3), -1.0), None),
        (np.full((12, 3), 1e6), None),
    ],
)
def test_colours_of_an_archive_in_any_scale(
    tmp_path: Path, rgb: np.ndarray, taken: int | None
) -> None:
    xyz = XYZ.reshape(3, 4, 3) if rgb.ndim == 3 else XYZ
    (tmp_path / "a.npz").write_bytes(archive(xyz=xyz, colors=rgb))
    cloud = read_cloud(tmp_path / "a.npz")
    if taken is None:
        assert cloud.rgb is None and cloud.notes == ["no colours: rgb holds something else"]
    else:
        assert cloud.rgb is not None and (cloud.rgb == taken).all()
