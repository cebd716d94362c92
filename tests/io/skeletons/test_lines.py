"""Skeletons of other tools as lines, and what is said of bad ones."""

import struct
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prunus.errors import PrunusError
from prunus.io.skeletons.export import write_graphml, write_ply
from prunus.io.skeletons.lines import read_lines
from prunus.io.skeletons.skeleton_file import write_skeleton
from prunus.io.skeletons.swc import write_swc
from tests.drawn import tree

OBJ = """# two edges
v 0 0 0
v 0 0 1
v 0 1 1
l 1 2 3
"""


@pytest.mark.parametrize("ending", ["json", "swc", "ply", "graphml"])
def test_what_prunus_writes_comes_back_as_lines(tmp_path: Path, ending: str) -> None:
    path = tmp_path / f"tree.{ending}"
    write = {"json": write_skeleton, "swc": write_swc, "ply": write_ply, "graphml": write_graphml}
    write[ending](path, tree())
    lines = read_lines(path)
    ends = np.sort(lines.xyz[lines.edges].reshape(-1, 6), axis=0)
    own = np.sort(tree().xyz[tree().edges].reshape(-1, 6), axis=0)
    assert ends == pytest.approx(own, abs=1e-6)


def test_the_polylines_of_an_obj(tmp_path: Path) -> None:
    path = tmp_path / "tree.obj"
    path.write_text(OBJ)
    assert read_lines(path).edges.tolist() == [[0, 1], [1, 2]]
    path.write_text(OBJ.replace("l 1 2 3", "l -3 -1"))
    assert read_lines(path).edges.tolist() == [[0, 2]]


OBJ_LINES = [
    ("v 0 0 0\nv 0 0 1\nl -2 -1\nv 0 1 1\nl -2 -1\n", [[0, 1], [1, 2]]),
    ("v 0 0 0\r\nv 0 0 1\r\nv 0 1 1\r\nl 1/1 2/1/1 3//2\r\n", [[0, 1], [1, 2]]),
    ("o a\nv 0 0 0 1.0\nv 0 0 1 1 1 1 1\nv 0 1 1 # tip\nl 1 2 \\\n  3\n", [[0, 1], [1, 2]]),
    ("l 1 2\nv 0 0 0\nv \\\n0 0 \\\n 1\nf 1 2 1\np 1\nvn 0 0 1\nl 2\n", [[0, 1]]),
    ("\ufeffv 0 0 0\nv 0 0 1\n\n\tl\t1\t2", [[0, 1]]),
]  # fmt: skip


@pytest.mark.parametrize(("text", "edges"), OBJ_LINES)
def test_lines_of_an_obj_however_they_are_written(
    tmp_path: Path, text: str, edges: list[list[int]]
) -> None:
    (tmp_path / "tree.obj").write_text(text, encoding="utf-8", newline="")
    assert read_lines(tmp_path / "tree.obj").edges.tolist() == edges


PLACES = np.array([[0, 0, 0], [0, 0, 0.5], [0.25, 0, 1], [-0.25, 0, 1]])
ENDS = [[0, 1], [1, 2], [1, 3]]
XYZ = ["property float x", "property double y", "property float z"]
LIST = "property list uchar int vertex_indices"
ORDERS = {"binary_little_endian": "<", "binary_big_endian": ">"}


def ply(form: str, elements: list[tuple[str, list[str], str, list[list[float]]]]) -> bytes:
    """A PLY file: each element with its properties, how `struct` packs a row, and its rows."""
    head = ["ply", f"format {form} 1.0", "comment of another program"]
    for name, properties, _, rows in elements:
        head += [f"element {name} {len(rows)}", *properties]
    body = b""
    for _, _, kinds, rows in elements:
        for row in rows:
            if form == "ascii":
                body += " ".join(f"{value:g}" for value in row).encode() + b"\n"
            else:
                body += struct.pack(ORDERS[form] + kinds, *row)
    return ("\n".join([*head, "end_header"]) + "\n").encode() + body


NODES = ("vertex", XYZ, "fdf", PLACES.tolist())
PAIRS = ["property int vertex1", "property int vertex2"]
COLOUR = [f"property uchar {name}" for name in ("red", "green", "blue")]
LISTED = [[2, *ends] for ends in ENDS]
LINE_PLYS = {
    "open3d": [NODES, ("edge", PAIRS + COLOUR, "iiBBB", [[*ends, 1, 2, 3] for ends in ENDS])],
    "blender": [NODES, ("face", [LIST], "Biii", []), ("edge", PAIRS, "ii", ENDS)],
    "blender with faces": [
        NODES, ("face", [LIST], "Biii", [[3, 0, 1, 2]]), ("edge", PAIRS, "ii", ENDS),
    ],
    "edges first": [("edge", PAIRS[::-1], "ii", [ends[::-1] for ends in ENDS]), NODES],
    "adtree": [NODES, ("edge", [LIST], "Bii", LISTED)],
    "vertex_index": [NODES, ("edge", [LIST.replace("indices", "index")], "Bii", LISTED)],
    "faces of two": [NODES, ("face", [LIST], "Bii", LISTED)],
    "unsigned": [NODES, ("edge", ["property uint vertex1", "property ushort vertex2"], "IH", ENDS)],
    "lists at the nodes": [
        ("vertex", [*XYZ, "property list uchar float near"], "fdfBf", [[*p, 1, 9] for p in PLACES]),
        ("edge", PAIRS, "ii", ENDS),
    ],
}  # fmt: skip


@pytest.mark.parametrize("form", ["ascii", *ORDERS])
@pytest.mark.parametrize("name", LINE_PLYS)
def test_lines_of_a_ply_as_other_programs_write_them(tmp_path: Path, form: str, name: str) -> None:
    (tmp_path / "tree.ply").write_bytes(ply(form, LINE_PLYS[name]))
    lines = read_lines(tmp_path / "tree.ply")
    assert lines.xyz.tolist() == PLACES.tolist()
    assert lines.edges.tolist() == ENDS


@pytest.mark.parametrize(
    ("elements", "says"),
    [
        ([NODES], "no element 'face'"),
        ([NODES, ("edge", PAIRS, "ii", [])], "no edges"),
        ([NODES, ("face", [LIST], "Bii", [])], "no edges"),
        ([NODES, ("face", [LIST], "Biii", [[3, 0, 1, 2]])], "more or less than two vertices"),
        ([NODES, ("edge", ["property int a"], "i", [[0]])], "the edges hold a"),
        ([NODES, ("edge", PAIRS, "ii", [[0, 4]])], "an edge to node 4; expected 0 to 3"),
        ([NODES, ("edge", PAIRS, "ii", [[-1, 0]])], "an edge to node -1"),
        ([NODES, ("edge", [p.replace("int", "float") for p in PAIRS], "ff", [[0.5, 1]])], "whole"),
        ([("vertex", XYZ[:2], "fd", [[0, 0], [1, 1]]), ("edge", PAIRS, "ii", [[0, 1]])], "x, y, z"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("form", ["ascii", "binary_little_endian"])
def test_a_ply_without_lines_is_refused(
    tmp_path: Path, form: str, elements: list[Any], says: str
) -> None:
    (tmp_path / "tree.ply").write_bytes(ply(form, elements))
    with pytest.raises(PrunusError, match=says):
        read_lines(tmp_path / "tree.ply")


GRAPHML = """<?xml version="1.0"?><graphml xmlns="http://graphml.graphdrawing.org/xmlns">
<key id="k0" for="node" attr.name="x" attr.type="double"/><key id="k1" attr.name="y"/>
<key id="k2" for="node" attr.name="z"><default>0.5</default></key><key id="k3" attr.name="y"/>
<graph edgedefault="undirected">
<node id="a"><data key="k0">0</data><data key="k1">1</data><data key="unknown">9</data></node>
<node id="b"><data key="k0">2</data><data key="k3">3</data><data key="k2"> 4 </data></node>
<edge source="b" target="a"/></graph></graphml>"""


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_graphml_of_others_with_defaults(tmp_path: Path, encoding: str) -> None:
    (tmp_path / "tree.graphml").write_text(GRAPHML, encoding=encoding)
    lines = read_lines(tmp_path / "tree.graphml")
    assert lines.xyz.tolist() == [[0, 1, 0.5], [2, 3, 4]]
    assert lines.edges.tolist() == [[1, 0]]


BOMB = (
    "<!DOCTYPE g [<!ENTITY a '" + "x" * 1000 + "'>"
    + "".join(f"<!ENTITY {b} '{f'&{a};' * 10}'>" for a, b in pairwise("abcdefgh"))
    + "]><g>&h;</g>"
)  # fmt: skip


@pytest.mark.parametrize(
    ("name", "text", "says"),
    [
        ("a.obj", "v 0 0 0\nv 0 0 1\n", "no edges"),
        ("a.obj", "v 0 0\nl 1 1\n", "line 1: 2 numbers; expected `v x y z`"),
        ("a.obj", "v 0 0 0\nv 0 0 \\\n\nl 1 1\n", "line 3: 2 numbers"),
        ("a.obj", "v 0 0 0\nv 0 0 1\nl 1 5\n", "edge to node 4"),
        ("a.obj", "v 0 0 0\nv 0 0 1\nl 1 0\n", "line 3: vertex 0; expected 1 or more"),
        ("a.obj", "v 0 0 0\nv 0 0 1\nl 1 -3\n", "line 3: vertex -3"),
        ("a.obj", f"v 0 0 0\nv 0 0 1\nl 1 {10**30}\n", "line 3: vertex 1000"),
        ("a.obj", "v 0 0 0\nv 0 0 1\nl 1 two\n", "line 3"),
        ("a.obj", "v 0 0 0\nv 0 0 nan\nl 1 2\n", "NaN or infinity"),
        ("a.obj", "v 0 0 zero\n", "line 1"),
        ("a.obj", "v 0 0 0\nv 0 0 1\nv 0 1 1\nf 1 2 3\n", "no edges"),
        ("a.obj", "v 0 0 0\0", "zero bytes"),
        ("a.obj", "v 0 0 0\nv 0 0 1e9\nl 1 2\n", "1e.09 units of lines; expected a tree in metres"),
        ("a.swc", "1 1 0 0 0 0 -1\n2 1 1e308 1e308 -1e308 0 1\n", "units of lines"),
        ("a.graphml", "<graphml", "not XML"),
        ("a.graphml", BOMB, "not XML"),
        ("a.graphml", "<?xml version='1.0' encoding='klingon'?><g/>", "not XML"),
        ("a.graphml", GRAPHML.replace('target="a"', 'target="c"'), "an edge to 'c'"),
        ("a.graphml", GRAPHML.replace('id="b"', 'id="a"'), "node 'a' stands twice"),
        ("a.graphml", GRAPHML.replace(">1<", ">one<"), "without x, y, z"),
        ("a.graphml", GRAPHML.replace(">1<", "><"), "without x, y, z"),
        ("a.graphml", "<graphml><graph><node id='a'/></graph></graphml>", "without x, y, z"),
        ("a.stl", "solid", "expected one of"),
    ],
)
def test_what_is_wrong_is_said(tmp_path: Path, name: str, text: str, says: str) -> None:
    path = tmp_path / name
    path.write_text(text)
    with pytest.raises(PrunusError, match=says) as error:
        read_lines(path)
    assert str(path) in str(error.value)


GOOD = {
    "a.obj": OBJ.encode(),
    "b.obj": b"v 0 0 0\nv 0 0 1\nv 0 1 1\nl -3 -2 \\\n-1\n",
    "a.graphml": GRAPHML.encode(),
    **{f"{name}.ply": ply("ascii", LINE_PLYS[name]) for name in LINE_PLYS},
    **{f"{name}_.ply": ply("binary_little_endian", LINE_PLYS[name]) for name in LINE_PLYS},
}


@pytest.mark.parametrize("name", GOOD)
@settings(deadline=None, max_examples=40)
@given(data=st.data())
def test_any_damage_is_read_or_refused(
    tmp_path_factory: pytest.TempPathFactory, name: str, data: st.DataObject
) -> None:
    content = bytearray(GOOD[name])
    for _ in range(data.draw(st.integers(1, 3))):
        at = data.draw(st.integers(0, len(content) - 1))
        content[at : at + data.draw(st.integers(0, 3))] = data.draw(st.binary(max_size=3))
    if data.draw(st.booleans()):
        del content[data.draw(st.integers(0, len(content))) :]
    path = tmp_path_factory.mktemp("spoiled") / name
    path.write_bytes(bytes(content))
    try:
        lines = read_lines(path)
    except PrunusError as error:
        assert "\n" not in str(error)
    else:
        assert np.isfinite(lines.xyz).all() and (lines.edges < len(lines.xyz)).all()
