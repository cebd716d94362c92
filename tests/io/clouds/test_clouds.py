"""Clouds from files: every kind read back, every fault refused by name."""

from pathlib import Path

import laspy
import numpy as np
import pytest
from pypcd4 import Encoding
from pypcd4 import PointCloud as Pcd

from prunus.errors import PrunusError
from prunus.io.clouds.cloud_file import read_cloud, write_cloud
from prunus.io.ply import ply_bytes, table_of

XYZ = np.round(np.random.default_rng(0).uniform(-1, 1, (60, 3)), 6)
RGB = np.random.default_rng(1).integers(0, 256, (60, 3)).astype(np.uint8)
UTM = XYZ + np.array([612_345.125, 5_123_456.25, 321.0])


@pytest.mark.parametrize("ending", [".ply", ".xyz", ".txt", ".csv", ".npz"])
def test_what_is_written_reads_back_with_colours(tmp_path: Path, ending: str) -> None:
    write_cloud(tmp_path / f"c{ending}", UTM, RGB)
    cloud = read_cloud(tmp_path / f"c{ending}")
    assert cloud.xyz == pytest.approx(UTM, abs=1e-5, rel=0)
    assert cloud.rgb is not None and (cloud.rgb == RGB).all()


def test_npy_holds_points_only(tmp_path: Path) -> None:
    write_cloud(tmp_path / "c.npy", XYZ, RGB)
    cloud = read_cloud(tmp_path / "c.npy")
    assert (cloud.xyz == XYZ).all() and cloud.rgb is None


@pytest.mark.parametrize("encoding", [Encoding.ASCII, Encoding.BINARY, Encoding.BINARY_COMPRESSED])
def test_pcd_in_all_its_encodings(tmp_path: Path, encoding: Encoding) -> None:
    path = tmp_path / "c.pcd"
    Pcd.from_xyzi_points(np.column_stack([XYZ, np.ones(60)]).astype(np.float32)).save(
        path, encoding
    )
    assert read_cloud(path).xyz == pytest.approx(XYZ, abs=1e-6)


def test_pixels_of_a_pcd_that_saw_nothing_are_left_out_and_said(tmp_path: Path) -> None:
    holed = XYZ.astype(np.float32)
    holed[3:9] = np.nan
    Pcd.from_xyz_points(holed).save(tmp_path / "c.pcd")
    cloud = read_cloud(tmp_path / "c.pcd")
    assert len(cloud.xyz) == 54
    assert cloud.notes == ["6 of 60 points are not finite (NaN) and were left out"]


def test_pcd_colours_are_unpacked(tmp_path: Path) -> None:
    packed = Pcd.encode_rgb(RGB).reshape(-1, 1)
    points = np.column_stack([XYZ.astype(np.float32), packed.view(np.float32)])
    Pcd.from_xyzrgb_points(points).save(tmp_path / "c.pcd")
    rgb = read_cloud(tmp_path / "c.pcd").rgb
    assert rgb is not None and (rgb == RGB).all()


@pytest.mark.parametrize("ending", [".las", ".laz"])
def test_las_in_large_coordinates(tmp_path: Path, ending: str) -> None:
    header = laspy.LasHeader(point_format=2, version="1.2")
    header.offsets, header.scales = UTM.min(axis=0), np.full(3, 1e-4)
    las = laspy.LasData(header)
    las.x, las.y, las.z = UTM.T
    las.red, las.green, las.blue = RGB.T.astype(np.uint16) * 256
    las.write(tmp_path / f"c{ending}")
    cloud = read_cloud(tmp_path / f"c{ending}")
    assert cloud.xyz == pytest.approx(UTM, abs=1e-4, rel=0)
    assert cloud.rgb is not None and (cloud.rgb == RGB).all()


@pytest.mark.parametrize("form", ["ascii", "binary_little_endian", "binary_big_endian"])
@pytest.mark.parametrize("kind", ["float", "double"])
def test_ply_of_every_form_with_extra_properties_and_faces(
    tmp_path: Path, form: str, kind: str
) -> None:
    order = ">" if form.endswith("big_endian") else "<"
    code = order + ("f4" if kind == "float" else "f8")
    table = np.zeros(60, [("nx", code), ("x", code), ("label", "u1"), ("y", code), ("z", code)])
    table["x"], table["y"], table["z"] = XYZ.T
    header = (
        f"ply\nformat {form} 1.0\ncomment made by hand\nelement vertex 60\nproperty {kind} nx\n"
        f"property {kind} x\nproperty uchar label\nproperty {kind} y\nproperty {kind} z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    )
    rows = "\n".join(" ".join(repr(v.item()) for v in row) for row in table) + "\n3 0 1 2\n"
    body = rows.encode() if form == "ascii" else table.tobytes() + b"\x03" + bytes(12)
    (tmp_path / "c.ply").write_bytes(header.encode() + body)
    assert read_cloud(tmp_path / "c.ply").xyz == pytest.approx(XYZ, abs=1e-6)


def test_text_with_and_without_a_header(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("intensity,X,Y,Z\n9,1,2,3\n9,4,5,6\n")
    (tmp_path / "b.txt").write_text("# made by hand\n1 2 3 7 7\n\n4 5 6 7 7\n")
    (tmp_path / "c.csv").write_text("1;2;3\n4;5;6\n")
    for name in ("a.csv", "b.txt", "c.csv"):
        assert read_cloud(tmp_path / name).xyz.tolist() == [[1, 2, 3], [4, 5, 6]], name


GOOD = ply_bytes({"vertex": table_of({"x": XYZ[:, 0], "y": XYZ[:, 1], "z": XYZ[:, 2]})}, [])


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("empty.ply", b"", "the file is empty"),
        ("empty.xyz", b"\n\n", "holds no points; expected rows of numbers"),
        ("header.ply", b"plx\nformat ascii 1.0\nend_header\n", "not a PLY file"),
        ("format.ply", b"ply\nelement vertex 1\nend_header\n", "names no format"),
        ("word.ply", b"ply\nformat ascii 1.0\nelephant\nend_header\n", "holds 'elephant'"),
        (
            "element.ply",
            b"ply\nformat ascii 1.0\nelement face 0\nend_header\n",
            "no element 'vertex'",
        ),
        ("column.ply", GOOD.replace(b"double z", b"double q"), "no column 'z' among x, y, q"),
        ("cut.ply", GOOD[:-500], "truncated: the header promises 60 rows of 'vertex', the file"),
        (
            "cut_ascii.ply",
            b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
            b"property float z\nend_header\n1 2 3\n",
            "truncated: the header promises 3 rows of 'vertex', the file holds 1",
        ),
        ("text.xyz", b"1 2 3\n4 five 6\n", "five.*row 1|'five'"),
        ("ragged.xyz", b"1 2 3\n4 5\n", "number of columns changed"),
        ("two.csv", b"1,2\n3,4\n", "rows hold 2 numbers; expected x, y, z"),
        ("bad.pcd", b"# .PCD v0.7\nVERSION 0.7\n", "not a readable PCD file"),
        ("bad.las", b"LASF" + bytes(300), "not a readable LAS or LAZ file"),
        ("bad.npy", b"\x93NUMPY\x01\x00", "not a readable numpy file"),
        ("bad.npz", b"PK\x03\x04 nothing", "not a readable numpy file"),
        ("noise.npz", bytes(range(256)), "not a numpy file"),
        ("kind.docx", b"1 2 3", "unknown kind of file '.docx'; expected one of .ply"),
    ],
)
def test_a_faulty_file_is_refused_by_name(
    tmp_path: Path, name: str, content: bytes, message: str
) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(PrunusError, match=f"(?s){name}: .*({message})"):
        read_cloud(tmp_path / name)


def test_missing_files_and_folders_are_refused(tmp_path: Path) -> None:
    with pytest.raises(PrunusError, match=r"none.ply: cannot be read \(No such file"):
        read_cloud(tmp_path / "none.ply")
    (tmp_path / "folder.ply").mkdir()
    with pytest.raises(PrunusError, match=r"folder.ply: a folder of no cloud; expected one cloud"):
        read_cloud(tmp_path / "folder.ply")


def test_arrays_of_the_wrong_kind_are_refused(tmp_path: Path) -> None:
    np.save(tmp_path / "flat.npy", np.zeros(9))
    np.savez(tmp_path / "two.npz", a=XYZ, b=XYZ)
    np.savez(tmp_path / "colours.npz", xyz=XYZ, rgb=RGB[:5])
    for name, message in [
        ("flat.npy", r"shape \(9,\); expected numbers \(P, 3\)"),
        ("two.npz", "holds a, b; expected an array 'xyz'"),
        ("colours.npz", r"rgb has shape \(5, 3\)"),
    ]:
        with pytest.raises(PrunusError, match=message):
            read_cloud(tmp_path / name)


@pytest.mark.parametrize(("unit", "factor"), [("mm", 1000.0), ("cm", 100.0)])
def test_other_units_are_seen_refused_and_read_when_named(
    tmp_path: Path, unit: str, factor: float
) -> None:
    write_cloud(tmp_path / "c.xyz", XYZ * factor)
    with pytest.raises(PrunusError, match=f"say --unit {unit}"):
        read_cloud(tmp_path / "c.xyz")
    assert read_cloud(tmp_path / "c.xyz", unit).xyz == pytest.approx(XYZ)
    assert read_cloud(tmp_path / "c.xyz", "m").xyz == pytest.approx(XYZ * factor)
    with pytest.raises(PrunusError, match="unknown unit 'inch'; expected one of m, cm, mm, ft"):
        read_cloud(tmp_path / "c.xyz", "inch")


UNIT_LENGTHS = {
    "m": 1,
    "cm": 0.01,
    "mm": 0.001,
    "ft": 0.3048,
    "us-ft": 0.3048006096012192,
    "in": 0.0254,
}


@pytest.mark.parametrize(("unit", "length"), UNIT_LENGTHS.items())
def test_every_unit_is_read_in_metres_and_said(tmp_path: Path, unit: str, length: float) -> None:
    np.save(tmp_path / "c.npy", XYZ)
    cloud = read_cloud(tmp_path / "c.npy", unit)
    assert cloud.xyz == pytest.approx(XYZ * length, rel=1e-12)
    assert cloud.unit == unit
    said = [f"unit {unit} as asked: all that is written is in metres"]
    assert cloud.notes == ([] if unit == "m" else said)


@pytest.mark.parametrize(
    ("comment", "length"),
    [
        ("unit: metre", 1), ("written by prunus; unit: metre", 1), ("unit: millimetre", 0.001),
        ("unit: foot; frame: local", 0.3048), ("unit: US survey foot", 0.3048006096012192),
        ("unit: furlong", 1), ("the unit is mm", 1),
    ],
)  # fmt: skip
def test_the_comment_of_a_ply_tells_its_unit(tmp_path: Path, comment: str, length: float) -> None:
    table = table_of(dict(zip("xyz", XYZ.T, strict=True)))
    (tmp_path / "c.ply").write_bytes(ply_bytes({"vertex": table}, [comment]))
    assert read_cloud(tmp_path / "c.ply").xyz == pytest.approx(XYZ * length, rel=1e-12)


def test_a_unit_against_the_comment_of_a_ply_wins_and_is_said(tmp_path: Path) -> None:
    write_cloud(tmp_path / "c.ply", XYZ * 1000)
    with pytest.raises(PrunusError, match="the header tells m; it looks like millimetres"):
        read_cloud(tmp_path / "c.ply")
    cloud = read_cloud(tmp_path / "c.ply", "mm")
    assert cloud.xyz == pytest.approx(XYZ)
    assert cloud.notes == ["unit mm as asked, but the header tells m"]


@pytest.mark.parametrize("name", ["tree", "tree.", "tree.gz", "tree.ply.zip", "tree.E58"])
def test_a_file_without_a_known_ending_is_refused_in_words(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_bytes(b"1 2 3\n")
    with pytest.raises(
        PrunusError, match=f"{name}: (unknown kind|no ending).*expected one of .ply"
    ):
        read_cloud(tmp_path / name)


@pytest.mark.parametrize("ending", [".PLY", ".XYZ", ".Csv", ".NPY"])
def test_endings_in_capitals_are_the_same(tmp_path: Path, ending: str) -> None:
    write_cloud(tmp_path / f"c{ending}", XYZ)
    assert read_cloud(tmp_path / f"c{ending}").xyz == pytest.approx(XYZ)


def test_a_folder_of_one_cloud_is_that_cloud(tmp_path: Path) -> None:
    write_cloud(tmp_path / "trees" / "a.npy", XYZ)
    (tmp_path / "trees" / "._a.npy").write_bytes(b"\0\5\x16\7")
    (tmp_path / "trees" / "README.txt").write_text("Scanned in May 2024.\nBy hand.\n")
    cloud = read_cloud(tmp_path / "trees")
    assert (cloud.xyz == XYZ).all() and cloud.name == "a.npy"
    write_cloud(tmp_path / "trees" / "b.xyz", XYZ)
    with pytest.raises(PrunusError, match=r"trees: a folder of 2 clouds: a\.npy, b\.xyz; expected"):
        read_cloud(tmp_path / "trees")


def test_an_unknown_ending_is_not_written(tmp_path: Path) -> None:
    with pytest.raises(PrunusError, match=r"c.obj: clouds are not written as '.obj'"):
        write_cloud(tmp_path / "c.obj", XYZ)
