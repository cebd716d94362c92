"""Laws of all readers: exactly the points that were written, or a refusal; whatever is cut off."""

import io
import struct
import zipfile
from collections.abc import Callable
from pathlib import Path

import laspy
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from prunus.errors import PrunusError
from prunus.files.safely import parsing
from prunus.io.clouds.cloud_file import read_cloud
from prunus.io.clouds.numpyfiles import read_npy, read_npz
from prunus.io.clouds.pcd import read_pcd
from prunus.io.clouds.readers import READERS
from prunus.io.clouds.text import read_text
from prunus.io.ply import TYPES, read_ply

HERE = Path("a.txt")
CLOUDS = arrays(
    np.float64, st.tuples(st.integers(1, 20), st.just(3)), elements=st.floats(-1e6, 1e6, width=32)
)
NAMES = st.text("abcdefgh_", min_size=1, max_size=8)
ORDERS = {"ascii": "<", "binary_little_endian": "<", "binary_big_endian": ">"}


@st.composite
def plys(draw: st.DrawFn) -> tuple[np.ndarray, bytes]:
    """A PLY with the points somewhere among further elements, properties and lists."""
    form = draw(st.sampled_from(sorted(ORDERS)))
    xyz = draw(CLOUDS)
    names = draw(st.lists(NAMES, max_size=3, unique=True))
    before = [_element(draw, name) for name in names if name not in ("vertex", "g", "b")]
    vertex = ("vertex", len(xyz), [(axis, None, "double") for axis in "xyz"])
    further = [
        (f"{name}2", *prop[1:]) for name, prop in zip(names, _properties(draw), strict=False)
    ]
    vertex = (*vertex[:2], draw(st.permutations([*vertex[2], *further])))
    elements = draw(st.permutations([*before, vertex]))
    lines, body = ["ply", f"format {form} 1.0"], b""
    for name, rows, properties in elements:
        lines.append(f"element {name} {rows}")
        for prop, count, kind in properties:
            lines.append(f"property {f'list {count} ' if count else ''}{kind} {prop}")
        for row in range(rows):
            cells = []
            for prop, count, kind in properties:
                if name == "vertex" and prop in "xyz":
                    cells.append(("f8", [xyz[row, "xyz".index(prop)]]))
                    continue
                held = [1] * draw(st.integers(0, 3)) if count else [1]
                cells += [(TYPES[count], [len(held)])] if count else []
                cells.append((TYPES[kind], held))
            body += _row(cells, form)
    return xyz, "\n".join([*lines, "end_header", ""]).encode() + body


def _properties(draw: st.DrawFn) -> list[tuple[str, str | None, str]]:
    kinds, counts = st.sampled_from(sorted(TYPES)), st.sampled_from(["uchar", "int", "uint16"])
    return draw(
        st.lists(
            st.tuples(NAMES, st.none() | counts, kinds),
            min_size=1,
            max_size=4,
            unique_by=lambda p: p[0],
        )
    )


def _element(draw: st.DrawFn, name: str) -> tuple[str, int, list[tuple[str, str | None, str]]]:
    return name, draw(st.integers(0, 5)), _properties(draw)


def _row(cells: list[tuple[str, list[float]]], form: str) -> bytes:
    if form == "ascii":
        return (
            " ".join(repr(float(v)) if k[0] == "f" else str(v) for k, held in cells for v in held)
            + "\n"
        ).encode()
    return b"".join(np.array(held, ORDERS[form] + kind).tobytes() for kind, held in cells)


@settings(deadline=None)
@given(plys())
def test_a_ply_gives_its_points_whatever_stands_beside_them(case: tuple[np.ndarray, bytes]) -> None:
    xyz, content = case
    table = read_ply(content, HERE)["vertex"]
    assert np.array_equal(np.column_stack([table[axis] for axis in "xyz"]), xyz)


@settings(deadline=None)
@given(plys(), st.data())
def test_a_ply_cut_off_anywhere_gives_all_points_or_none(
    case: tuple[np.ndarray, bytes], data: st.DataObject
) -> None:
    xyz, content = case
    cut = content[: data.draw(st.integers(0, len(content) - 1))]
    try:
        table = read_ply(cut, HERE)["vertex"]
    except PrunusError:
        return
    found = np.column_stack([table[axis] for axis in "xyz"])
    # The last number of a text may have lost digits: nothing tells.
    whole = len(xyz) - (b" ascii " in content)
    assert len(found) == len(xyz) and np.array_equal(found[:whole], xyz[:whole])


@settings(deadline=None)
@given(
    CLOUDS,
    st.sampled_from(["ascii", "binary", "binary_compressed"]),
    st.lists(
        st.tuples(NAMES, st.sampled_from(["U 1", "I 2", "F 4", "F 8", "U 4"]), st.integers(1, 3)),
        max_size=3,
        unique_by=lambda field: field[0],
    ),
    st.data(),
)
def test_a_pcd_gives_all_its_points_or_none(
    xyz: np.ndarray, form: str, further: list[tuple[str, str, int]], data: st.DataObject
) -> None:
    import lzf

    axes = [(axis, "F 8", 1) for axis in "xyz"]
    fields = data.draw(st.permutations([*axes, *((f"{name}2", *rest) for name, *rest in further)]))
    kind = np.dtype([(n, "<" + TYPES_OF[t], (c,)) for n, t, c in fields])
    table = np.zeros(len(xyz), kind)
    for axis, name in enumerate("xyz"):
        table[name] = xyz[:, axis, None]
    head = "".join(
        f"{key} {' '.join(words)}\n"
        for key, words in {
            "FIELDS": [n for n, _, _ in fields], "SIZE": [t[2:] for _, t, _ in fields],
            "TYPE": [t[0] for _, t, _ in fields], "COUNT": [str(c) for *_, c in fields],
            "WIDTH": [str(len(xyz))], "HEIGHT": ["1"], "DATA": [form],
        }.items()
    )  # fmt: skip
    body = table.tobytes()
    if form == "ascii":
        rows = [[repr(v) for name in kind.names or () for v in row[name].tolist()] for row in table]
        body = "".join(" ".join(row) + "\n" for row in rows).encode()
    elif form == "binary_compressed":
        held = b"".join(table[name].tobytes() for name in kind.names or ())
        small = lzf.compress(held, 2 * len(held) + 64)
        body = struct.pack("<2I", len(small), len(held)) + small
    content = head.encode() + body
    assert np.array_equal(read_pcd(content, HERE).xyz, xyz)
    cut = content[: data.draw(st.integers(0, len(content) - 1))]
    try:
        with parsing(HERE, "PCD"):
            found = read_pcd(cut, HERE).xyz
    except PrunusError:
        return
    assert form == "ascii" and np.array_equal(found[:-1], xyz[:-1])


TYPES_OF = {"U 1": "u1", "I 2": "i2", "F 4": "f4", "F 8": "f8", "U 4": "u4"}


@settings(deadline=None)
@given(
    CLOUDS,
    st.sampled_from([" ", "\t", ",", ";", "|", ", "]),
    st.sampled_from(["\n", "\r\n", "\r"]),
    st.permutations(["x", "Y", "z", "class", "i"]),
    st.sampled_from(["utf-8", "utf-8-sig", "utf-16"]),
    st.lists(st.sampled_from(["# by hand", "", "// a, b", "% 7 words"]), max_size=3),
    st.booleans(),
)
def test_text_gives_its_points_wherever_their_columns_are(
    xyz: np.ndarray,
    separator: str,
    end: str,
    names: list[str],
    coding: str,
    before: list[str],
    counted: bool,
) -> None:
    columns = {"x": xyz[:, 0], "Y": xyz[:, 1], "z": xyz[:, 2]}
    rows = [
        separator.join(
            "oak" if name == "class" else "nan" if name == "i" else repr(float(columns[name][row]))
            for name in names
        )
        for row in range(len(xyz))
    ]
    lines = [*before, separator.join(names), *[str(len(xyz))] * counted, *rows, ""]
    assert np.array_equal(read_text(end.join(lines).encode(coding), HERE).xyz, xyz)


@settings(deadline=None)
@given(CLOUDS, st.data())
def test_text_cut_off_gives_the_rows_before_the_cut_or_a_refusal(
    xyz: np.ndarray, data: st.DataObject
) -> None:
    text = "\n".join(" ".join(map(repr, row)) for row in xyz.tolist())
    counted = f"{len(xyz)}\n{text}\n".encode()
    cut = data.draw(st.integers(0, len(counted) - 1))
    for content, whole in ((text.encode()[:cut], False), (counted[:cut], True)):
        try:
            found = read_text(content, HERE).xyz
        except PrunusError:
            continue
        assert np.array_equal(found[:-1], xyz[: len(found) - 1])
        assert len(found) == len(xyz) or not whole


@settings(deadline=None)
@given(CLOUDS, st.sampled_from(["C", "F"]), st.sampled_from("<>"), st.integers(3, 6), st.data())
def test_an_array_gives_all_its_points_or_none(
    xyz: np.ndarray, layout: str, order: str, columns: int, data: st.DataObject
) -> None:
    held = np.zeros((len(xyz), columns), order + "f8", layout)
    held[:, :3] = xyz
    out = io.BytesIO()
    np.save(out, held)
    packed = io.BytesIO()
    np.savez_compressed(packed, xyz=held)
    for content, read in ((out.getvalue(), read_npy), (packed.getvalue(), read_npz)):
        if columns > max(3, len(xyz)):
            with pytest.raises(PrunusError, match="points across"):
                read(content, HERE)
            continue
        assert np.array_equal(read(content, HERE).xyz, xyz)
        cut = content[: data.draw(st.integers(0, len(content) - 1))]
        with pytest.raises(PrunusError), parsing(HERE, "array"):
            read(cut, HERE)


@pytest.mark.parametrize("form", range(11))
@pytest.mark.parametrize("ending", [".las", ".laz"])
def test_a_las_cut_off_anywhere_is_refused(tmp_path: Path, form: int, ending: str) -> None:
    xyz = np.round(np.random.default_rng(form).uniform(-1, 1, (30, 3)), 3)
    header = laspy.LasHeader(point_format=form, version="1.4" if form > 5 else "1.3")
    header.scales = np.full(3, 1e-3)
    las = laspy.LasData(header)
    las.x, las.y, las.z = xyz.T
    path = tmp_path / f"a{ending}"
    las.write(path)
    content = path.read_bytes()
    assert read_cloud(path).xyz == pytest.approx(xyz, abs=1e-9)
    for cut in [*range(0, len(content), 37), len(content) - 1]:
        path.write_bytes(content[:cut])
        with pytest.raises(PrunusError, match=rf"a\{ending}: "):
            read_cloud(path)


SCREAMING = (
    MemoryError(),
    OverflowError("too large"),
    zipfile.BadZipFile("bad"),
    RecursionError(),
    KeyError("k"),
    UnicodeDecodeError("utf-8", b"a", 0, 1, "why"),
    BaseException("panic"),
)


@pytest.mark.parametrize("error", SCREAMING, ids=lambda error: type(error).__name__)
@pytest.mark.parametrize("ending", READERS)
def test_whatever_a_library_raises_names_the_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: BaseException, ending: str
) -> None:
    def scream(*_: object) -> None:
        raise error

    monkeypatch.setitem(READERS, ending, scream)
    (tmp_path / f"a{ending}").write_bytes(b"x")
    with pytest.raises(PrunusError, match=rf"a\{ending}: (not a readable|too large)") as refused:
        read_cloud(tmp_path / f"a{ending}")
    assert refused.value.__cause__ is error


@pytest.mark.parametrize("error", [KeyboardInterrupt, SystemExit, GeneratorExit])
def test_the_door_stops_nobody_who_leaves(error: type[BaseException]) -> None:
    with pytest.raises(error), parsing("a", "file"):
        raise error


@settings(deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.sampled_from(sorted(READERS)), st.binary(min_size=1, max_size=300))
def test_noise_is_refused_by_name(tmp_path: Path, ending: str, content: bytes) -> None:
    magic = {
        ".ply": b"ply\n",
        ".las": b"LASF",
        ".laz": b"LASF",
        ".npy": b"\x93NUMPY",
        ".npz": b"PK",
    }
    (tmp_path / f"a{ending}").write_bytes(magic.get(ending, b"") + content)
    reader: Callable[[Path], object] = read_cloud
    try:
        reader(tmp_path / f"a{ending}")
    except PrunusError as error:
        assert f"a{ending}: " in str(error) and "\n" not in str(error)
