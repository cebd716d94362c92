"""PLY as other programs write it: all rows of what is wanted, whatever stands before and beside."""

import struct
from pathlib import Path

import numpy as np
import pytest

from prunus.errors import PrunusError
from prunus.io.clouds.cloud_file import read_cloud
from prunus.io.ply import read_ply

XYZ = np.round(np.random.default_rng(3).uniform(0, 1, (6, 3)), 3)
HERE = Path("a.ply")
VERTEX = ["element vertex 6", "property float x", "property double y", "property float32 z"]
FACES = ["element face 2", "property list uchar int vertex_indices"]
POLYGONS = {"ascii": b"3 0 1 2\n4 0 1 2 3\n"}
POINTS = {"ascii": b"".join(b"%.3f %.3f %.3f\n" % tuple(row) for row in XYZ)}
for form, mark in (("binary_little_endian", "<"), ("binary_big_endian", ">")):
    POLYGONS[form] = struct.pack(f"{mark}B3iB4i", 3, 0, 1, 2, 4, 0, 1, 2, 3)
    POINTS[form] = b"".join(struct.pack(f"{mark}fdf", *row) for row in XYZ)


def ply(form: str, *lines: str, body: bytes, end: str = "\n") -> bytes:
    head = ["ply", f"format {form} 1.0", *lines, "end_header", ""]
    return end.join(head).encode() + body


def points(content: bytes) -> np.ndarray:
    table = read_ply(content, HERE)["vertex"]
    return np.column_stack([table[axis] for axis in "xyz"])


@pytest.mark.parametrize("form", POINTS)
def test_faces_may_come_first(form: str) -> None:
    content = ply(form, *FACES, *VERTEX, body=POLYGONS[form] + POINTS[form])
    assert points(content) == pytest.approx(XYZ, abs=1e-7)


@pytest.mark.parametrize("form", POINTS)
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_every_line_end_is_one(form: str, end: str) -> None:
    body = POINTS[form].replace(b"\n", end.encode()) if form == "ascii" else POINTS[form]
    assert points(ply(form, *VERTEX, body=body, end=end)) == pytest.approx(XYZ, abs=1e-7)


def test_points_that_begin_like_a_line_end_are_points() -> None:
    first = np.frombuffer(b"\n\r\n\n\r\n\n\r", "<f8")[0]
    body = struct.pack("<3d", first, 1, 2)
    head = ["element vertex 1", *(f"property double {axis}" for axis in "xyz")]
    for end in ("\n", "\r\n", "\r"):
        assert points(ply("binary_little_endian", *head, body=body, end=end))[0, 0] == first


@pytest.mark.parametrize("form", POINTS)
def test_empty_elements_words_and_comments_are_passed_over(form: str) -> None:
    content = ply(
        form,
        "comment the old end_header stood here",
        "obj_info end_header",
        "element tri 0",
        "property int a",
        "",
        *VERTEX,
        "element camera 1",
        "property float view_px",
        body=POINTS[form],
    )
    assert points(content) == pytest.approx(XYZ, abs=1e-7)


def test_blank_lines_are_no_rows_and_a_mark_is_no_word() -> None:
    body = b"\n" + POINTS["ascii"].replace(b"\n", b"\n\n \n")
    content = b"\xef\xbb\xbf" + ply("ascii", *VERTEX, body=body)
    assert points(content).tolist() == XYZ.tolist()


def test_text_keeps_its_digits_whatever_the_header_calls_its_numbers() -> None:
    content = ply("ascii", *VERTEX, body=b"612345.125 5123456.789 321.001\n" * 6)
    assert points(content)[0].tolist() == [612345.125, 5123456.789, 321.001]


def test_the_second_of_three_elements_keeps_its_first_row() -> None:
    lines = ["element a 1", "property int k", *VERTEX, "element b 2", "property int k"]
    content = ply("ascii", *lines, body=b"9\n" + POINTS["ascii"] + b"7\n8\n")
    tables = read_ply(content, HERE, ("vertex", "b"))
    assert tables["vertex"]["x"].tolist() == XYZ[:, 0].tolist()
    assert tables["b"]["k"].tolist() == [7, 8]


@pytest.mark.parametrize("form", POINTS)
def test_lists_are_stepped_over_and_given(form: str) -> None:
    tables = read_ply(
        ply(form, *FACES, *VERTEX, body=POLYGONS[form] + POINTS[form]), HERE, ("face", "vertex")
    )
    held = tables["face"]["vertex_indices"]
    assert [row.tolist() for row in held] == [[0, 1, 2], [0, 1, 2, 3]]
    assert tables["vertex"]["z"] == pytest.approx(XYZ[:, 2])


@pytest.mark.parametrize(
    "lengths", [(2,) * 7, (2, 2, 3, 2, 2, 2, 2), (0, 1, 2, 3, 4, 5, 6), (0,) * 7]
)
def test_lists_of_all_lengths_between_other_properties(lengths: tuple[int, ...]) -> None:
    lines = [
        "element path 7",
        "property uchar a",
        "property list ushort double k",
        "property list char short m",
        "property float b",
        *VERTEX,
    ]
    body = b"".join(
        struct.pack(f"<BH{n}db2hf", row, n, *range(n), 2, -1, row, 0.5)
        for row, n in enumerate(lengths)
    )
    content = ply("binary_little_endian", *lines, body=body + POINTS["binary_little_endian"])
    tables = read_ply(content, HERE, ("path", "vertex"))
    path = tables["path"]
    assert [row.tolist() for row in path["k"]] == [list(range(n)) for n in lengths]
    assert path["m"].tolist() == [[-1, row] for row in range(7)]
    assert path["a"].tolist() == list(range(7)) and (path["b"] == 0.5).all()
    assert tables["vertex"]["x"] == pytest.approx(XYZ[:, 0])


def test_colours_by_their_old_names(tmp_path: Path) -> None:
    names = [f"property uint8 diffuse_{colour}" for colour in ("red", "green", "blue")]
    body = POINTS["ascii"].replace(b"\n", b" 1 2 255\n")
    (tmp_path / "a.ply").write_bytes(ply("ascii", *VERTEX, *names, body=body))
    cloud = read_cloud(tmp_path / "a.ply")
    assert cloud.rgb is not None and (cloud.rgb == [1, 2, 255]).all()


ONE = ["element vertex 2", *(f"property float {axis}" for axis in "xyz")]


@pytest.mark.parametrize(
    ("lines", "body", "said"),
    [
        (
            VERTEX,
            POINTS["ascii"][:-20],
            "truncated: the header promises 6 rows of 'vertex', the file",
        ),
        (
            FACES + VERTEX,
            b"3 0 1 2\n" + POINTS["ascii"],
            "promises 6 rows of 'vertex', the file holds 5",
        ),
        (ONE, b"1 2 3\n4 5\n", "columns changed"),
        (ONE, b"1 2 3\n4 5 x\n", "could not convert string 'x'"),
        (ONE, b"1 2 3 4\n4 5 6 7\n", "rows hold 4 numbers; expected 3"),
        (
            [*ONE, "property uchar red"],
            b"1 2 3 4\n4 5 6 256\n",
            "'red' holds 256; .* from 0 to 255",
        ),
        ([*ONE, "property int k"], b"1 2 3 4\n4 5 6 0.5\n", "'k' holds 0.5; .* whole numbers"),
        (
            [*ONE, "property list uchar int k"],
            b"1 2 3 1 5\n4 5 6 2 5\n",
            "row 2 of 'vertex': too short",
        ),
        ([*ONE, "property list char int k"], b"1 2 3 1 5\n4 5 6 -1\n", "a list 'k' of -1 numbers"),
        (
            [*ONE, "property list char int k"],
            b"1 2 3 0 5\n4 5 6 0\n",
            "row 1 of 'vertex': too long",
        ),
        ([*ONE, "property float x"], b"", "names 'x' twice"),
        ([*ONE, *ONE], b"", "names 'vertex' twice"),
        (["element vertex -1"], b"", "holds 'element vertex -1', which means nothing"),
        (["element vertex 9999999999999999999999"], b"", "means nothing"),
        ([*ONE, "property list float int k"], b"", "holds 'property list float int k'"),
        (["element vertex 999999999999999999", *ONE[1:]], b"1 2 3\n", "truncated: .* holds 1"),
    ],
)
def test_what_is_wrong_is_named(lines: list[str], body: bytes, said: str) -> None:
    with pytest.raises(PrunusError, match=f"a.ply: .*{said}"):
        read_ply(ply("ascii", *lines, body=body), HERE)


@pytest.mark.parametrize(
    ("lines", "body", "said"),
    [
        (["element vertex 999999999999", *ONE[1:]], bytes(36), "promises 999999999999 .* holds 3"),
        ([*ONE, "property list uint double k"], bytes(12) + b"\xff" * 40, "truncated: .* holds 0"),
        ([*ONE, "property list char int k"], bytes(12) + b"\xff" * 40, "a list 'k' of -1 numbers"),
        ([*ONE, "property list char int k"], bytes(13 + 5), "truncated: .* holds 1"),
    ],
)
def test_a_lying_binary_header_allocates_nothing(lines: list[str], body: bytes, said: str) -> None:
    with pytest.raises(PrunusError, match=f"a.ply: .*{said}"):
        read_ply(ply("binary_little_endian", *lines, body=body), HERE)


@pytest.mark.parametrize(
    "head", [b"ply", b"PLY\nformat ascii 1.0\n", b"plywood\n", b"ply\nformat x 1\n"]
)
def test_what_is_no_ply_is_said(head: bytes) -> None:
    with pytest.raises(PrunusError, match=r"a\.ply: "):
        read_ply(head, HERE)
