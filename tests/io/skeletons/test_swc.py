"""SWC: ours there and back, and what other programs write."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prunus.errors import PrunusError
from prunus.io.skeletons.lines import read_lines
from prunus.io.skeletons.skeleton_file import read_skeleton
from prunus.io.skeletons.swc import read_rows, write_swc
from prunus.model import Label
from tests.drawn import tree
from tests.io.skeletons.test_skeletons import random_skeleton, same


@settings(deadline=None, max_examples=30)
@given(seed=st.integers(0, 10_000))
def test_swc_gives_back_the_tree(tmp_path_factory: pytest.TempPathFactory, seed: int) -> None:
    skeleton = random_skeleton(seed)
    path = tmp_path_factory.mktemp("swc") / "skeleton.swc"
    write_swc(path, skeleton)
    assert same(read_skeleton(path), skeleton, "xyz", "parent", "label", "radius")


def test_swc_opens_in_morphio_with_its_radii_and_labels(tmp_path: Path) -> None:
    morphio = pytest.importorskip("morphio")
    morphio.set_maximum_warnings(0)
    skeleton = tree().with_radius(np.full(len(tree()), 0.01))
    write_swc(tmp_path / "s.swc", skeleton)
    opened = morphio.Morphology(
        str(tmp_path / "s.swc"), options=morphio.Option.allow_unifurcated_section_change
    )
    types = {int(section.type) for section in opened.sections}
    assert types == {16, 17, 18, 19}
    assert opened.diameters == pytest.approx(0.02)
    assert {tuple(point) for point in opened.points.round(4).tolist()} == {
        tuple(point) for point in skeleton.xyz.astype("f4").round(4).tolist()
    }


ROWS = ["1 16 0 0 0 0.02 -1", "2 16 0 0 0.25 0.02 1", "3 17 0.5 0 0.25 0 2", "4 17 -1e-1 0 .5 0 2"]
"""A trunk that forks, as we write it."""
NAMED = "id type x y z radius parent"
HUGE = 10**30


def lines(rows: list[str], join: str = "\n") -> str:
    return join.join(rows) + join


@pytest.mark.parametrize(
    "text",
    [
        lines(ROWS, "\r\n"),
        lines(ROWS, "\r"),
        lines(["\t" + row.replace(" ", "\t \t") for row in ROWS]),
        lines([row.replace(" ", ",") for row in ROWS]),
        lines([row.replace(" ", ", ") + "," for row in ROWS]),
        lines([row.replace(" ", ";") for row in ROWS]),
        lines([f"{row} 0 1 2.5 # seg_id level mode" for row in ROWS]),
        lines([f"{row} {'9 ' * k}" for k, row in enumerate(ROWS)]),
        lines([NAMED, *ROWS]),
        lines([NAMED.replace(" ", ","), *(row.replace(" ", ",") for row in ROWS)]),
        lines(['"n","T","X","Y","Z","R","P"', *(row.replace(" ", ",") for row in ROWS)]),
        lines(["parent_id x y z r n type"] + [
            " ".join([w[6], *w[2:6], w[0], w[1]]) for w in map(str.split, ROWS)
        ]),
        lines(["# CREATOR w\u00e4ldchen", "", "#n,type,x,y,z,radius,parent", *ROWS, "", "#"]),
        lines([ROWS[0], *reversed(ROWS[1:])]).replace("\n3", "\n  3"),
        lines([" ".join(f"{float(word):.18e}" for word in row.split()) for row in ROWS]),
        lines([f"{HUGE} 16 0 0 0 0.02 -1", f"2 16 0 0 0.25 0.02 {HUGE}", *ROWS[2:]]),
        "\ufeff" + lines(ROWS),
    ],
    ids=str,
)  # fmt: skip
def test_however_it_is_written_it_is_the_same_tree(tmp_path: Path, text: str) -> None:
    (tmp_path / "a.swc").write_text(text, encoding="utf-8", newline="")
    read = read_skeleton(tmp_path / "a.swc")
    places = [(0, 0, 0), (0, 0, 0.25), (0.5, 0, 0.25), (-0.1, 0, 0.5)]
    assert sorted(map(tuple, read.xyz.tolist())) == sorted(places)
    above = {tuple(p): read.parent[row] for row, p in enumerate(read.xyz.tolist())}
    assert [above[place] for place in places][:3] == [-1, 0, 1] and above[places[3]] == 1
    assert read.label.tolist() == [Label.TRUNK, Label.TRUNK, Label.SUPPORT, Label.SUPPORT]
    assert read.radius == pytest.approx([0.02, 0.02, np.nan, np.nan], nan_ok=True)


def test_comments_in_an_old_code_page_are_passed_over(tmp_path: Path) -> None:
    (tmp_path / "a.swc").write_bytes(("# Wäldchen\n" + lines(ROWS)).encode("cp1252"))
    assert len(read_skeleton(tmp_path / "a.swc")) == 4


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("1 1 0 0 0 1 -1\n2 3 0 0 1 1 1\n7 2 5 0 0 1 -1\n8 2 5 0 1 1 7\n", [[0, 1], [2, 3]]),
        ("5 0 0 0 0 nan 9\n9 0 0 0 1 -1 -1\n", [[1, 0]]),
        ("0 1 0 0 0 1 -1\n1 1 0 0 1 1 0\n", [[0, 1]]),
        (f"1 {10**25} 0 0 0 1 -2\n2 -3 0 0 1 inf 1\n", [[0, 1]]),
    ],
)
def test_lines_are_read_of_any_types_roots_and_radii(
    tmp_path: Path, text: str, says: list[list[int]]
) -> None:
    (tmp_path / "a.swc").write_text(text)
    assert read_lines(tmp_path / "a.swc").edges.tolist() == says


@pytest.mark.parametrize("name", ["a.swc", "a.eswc"])
@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("1 16 0 0 0 0 -1\n2 16 0 0 1 0 3\n3 16 0 0 2 0 2\n", "line 2: their parents go round"),
        ("1 16 0 0 0 0 2\n2 16 0 0 1 0 1\n", "2 rows hang on no root"),
        ("1 16 0 0 0 0 -1\n2 16 0 0 1 0 2\n", "line 2: parent 2 is itself"),
        ("1 16 0 0 0 0 -1\n2 16 0 0 1 0 9\n", "line 2: parent 9 is no row"),
        (f"1 16 0 0 0 0 -1\n2 16 0 0 1 0 {'9' * 3000}\n", "is no row"),
        (f"1 16 0 0 0 0 -1\n{'9' * 5000} 16 0 0 1 0 1\n", "line 2: .* is no whole number"),
        ("# head\n1 16 0 0 0 0 -1\n1 16 0 0 1 0 1\n", "line 3: the id 1 stands twice"),
        ("1 16 0 0 0 0\n", "line 1: 6 columns; expected id type x y z radius parent"),
        ("1,16,0,0,0,0\n", "line 1: 6 columns"),
        ("1 16 0 0 0 0 -1\n\n2 16 0 0 1 1\n", "line 3: 6 columns"),
        ("1 16 0 0 nan 0 -1\n", "line 1: x, y or z is NaN"),
        ("1 16 0 0 0 0 -1\n2 16 0 1e999 1 0 1\n", "line 2: x, y or z is NaN"),
        ("nan 16 0 0 0 0 -1\n", "line 1: 'nan' is no whole number"),
        ("1.5 16 0 0 0 0 -1\n", "line 1: '1.5' is no whole number"),
        ("1 16 0 0 0 0 nan\n", "'nan' is no whole number"),
        ("1 16 0 0 0 0 1e300\n", "'1e300' is no whole number"),
        ("1;16;0,5;0;0;0;-1\n", "line 1: '0,5' is no number"),
        ("1 16 0,5 0 0 0 -1\n", "line 1: .*; expected id type x y z radius parent"),
        ("1 16 1_0 0 0 0 -1\n", "line 1: '1_0' is no number"),
        ("1 16 \u0663 0 0 0 -1\n", "is no number"),
        ("id x y z\n1 0 0 0\n", "line 1: 'id x y z'; expected id type x y z radius parent"),
        ("id type x y z radius parent parent\n", "line 1: "),
        (NAMED + "\n", "no rows"),
        ("# nothing\n", "no rows"),
        (" \n", "no rows"),
        ("", "the file is empty"),
    ],
)
def test_what_is_no_tree_is_refused_by_file_and_line(
    tmp_path: Path, name: str, text: str, says: str
) -> None:
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    with pytest.raises(PrunusError, match=says) as raised:
        read_lines(path)
    assert str(raised.value).startswith(f"{path}: ") and "\n" not in str(raised.value)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("1 16 0 0 0 0 -1\n2 16 0 0 1 0 -1\n", "2 rows without a parent"),
        ("1 5 0 0 0 0 -1\n", "type 5 is no label; expected .16, 17, 18, 19."),
        ("1 16 0 0 0 0 -1\n2 16 0 0 1 -0.5 1\n", "radius -0.5; expected 0"),
        ("1 16 0 0 0 inf -1\n", "radius inf"),
    ],
)
def test_a_skeleton_of_ours_is_one_tree_with_our_labels(
    tmp_path: Path, text: str, says: str
) -> None:
    (tmp_path / "a.swc").write_text(text)
    with pytest.raises(PrunusError, match=says):
        read_skeleton(tmp_path / "a.swc")


@settings(deadline=None, max_examples=100)
@given(
    text=st.text(st.sampled_from("0123456789.-+eE ,;\t\n#naif_\ufeff\u2028"), max_size=60),
    whole=st.booleans(),
)
def test_any_text_is_read_or_refused(
    tmp_path_factory: pytest.TempPathFactory, text: str, whole: bool
) -> None:
    path = tmp_path_factory.mktemp("swc") / "a.swc"
    path.write_text((lines(ROWS) if whole else "") + text, encoding="utf-8")
    try:
        read_rows(path)
    except PrunusError as error:
        assert "\n" not in str(error)
