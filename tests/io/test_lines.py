"""Skeletons of other tools as lines, and what is said of bad ones."""

from pathlib import Path

import numpy as np
import pytest

from prunus.errors import PrunusError
from prunus.io.export import write_graphml, write_ply
from prunus.io.lines import read_lines
from prunus.io.skeletons import write_skeleton
from prunus.io.swc import write_swc
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


def test_an_swc_of_any_types_and_several_roots(tmp_path: Path) -> None:
    path = tmp_path / "tree.swc"
    path.write_text("1 1 0 0 0 1 -1\n2 3 0 0 1 1 1\n7 2 5 0 0 1 -1\n8 2 5 0 1 1 7\n")
    assert read_lines(path).edges.tolist() == [[0, 1], [2, 3]]


@pytest.mark.parametrize(
    ("name", "text", "says"),
    [
        ("a.obj", "v 0 0 0\nv 0 0 1\n", "no edges"),
        ("a.obj", "v 0 0\nl 1 1\n", "three numbers"),
        ("a.obj", "v 0 0 0\nv 0 0 1\nl 1 5\n", "edge to node 4"),
        ("a.obj", "v 0 0 zero\n", "line 1"),
        ("a.swc", "1 1 0 0 0 1 -1\n2 1 0 0 1 1 9\n", "parent 9"),
        ("a.graphml", "<graphml", "not XML"),
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
