"""Skeletons from kind to kind: what comes back, what is lost and said, a base alone."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prunus.errors import PrunusError
from prunus.io.convert import FORMATS, convert_file
from prunus.io.ply import read_ply
from prunus.io.skeletons.lines import read_lines
from prunus.io.skeletons.skeleton_file import read_skeleton, write_skeleton
from prunus.model import Skeleton
from tests.drawn import tree
from tests.io.skeletons.test_skeletons import random_skeleton, same

HOLDS = {
    ".json": ("xyz", "parent", "label", "radius", "confidence", "superpoint"),
    ".swc": ("xyz", "parent", "label", "radius"),
}
"""What of a skeleton comes back from the kinds that are read as skeletons."""
LINES = [".json", ".swc", ".ply", ".graphml"]
"""The kinds that are read as lines."""


@settings(deadline=None, max_examples=40)
@given(seed=st.integers(0, 10_000), first=st.sampled_from([*HOLDS]), then=st.sampled_from([*HOLDS]))
def test_what_both_kinds_hold_comes_back_and_the_rest_is_said(
    tmp_path_factory: pytest.TempPathFactory, seed: int, first: str, then: str
) -> None:
    skeleton, home = random_skeleton(seed), tmp_path_factory.mktemp("there")
    write_skeleton(home / "s.json", skeleton)
    notes = convert_file(home / "s.json", home / f"a{first}")
    notes += convert_file(home / f"a{first}", home / f"b{then}")
    back = read_skeleton(home / f"b{then}")
    held = [column for column in HOLDS[first] if column in HOLDS[then]]
    assert same(back, skeleton, *held)
    if "confidence" not in held:
        assert np.isnan(back.confidence).all() and (back.superpoint == -1).all()
        known = {
            "confidence": np.isfinite(skeleton.confidence).any(),
            "superpoint": (skeleton.superpoint >= 0).any(),
        }
        said = " ".join(note for note in notes if "no place" in note)
        assert {column: column in said for column in known} == known


@settings(deadline=None, max_examples=40)
@given(seed=st.integers(0, 10_000), ending=st.sampled_from(LINES))
def test_lines_come_back_to_the_bit(
    tmp_path_factory: pytest.TempPathFactory, seed: int, ending: str
) -> None:
    skeleton, home = random_skeleton(seed), tmp_path_factory.mktemp("lines")
    write_skeleton(home / "s.json", skeleton)
    convert_file(home / "s.json", home / f"a{ending}")
    if len(skeleton) == 1:
        with pytest.raises(PrunusError, match="no edges"):
            read_lines(home / f"a{ending}")
        return
    lines = read_lines(home / f"a{ending}")
    assert np.array_equal(lines.xyz, skeleton.xyz)
    assert sorted(lines.edges.tolist()) == sorted(skeleton.edges.tolist())


@settings(deadline=None, max_examples=30)
@given(seed=st.integers(0, 10_000))
def test_a_ply_holds_labels_and_radii_of_the_nodes(
    tmp_path_factory: pytest.TempPathFactory, seed: int
) -> None:
    skeleton, path = random_skeleton(seed), tmp_path_factory.mktemp("ply") / "s.ply"
    FORMATS[".ply"].write(path, skeleton)
    vertex = read_ply(path.read_bytes(), path)["vertex"]
    assert vertex["label"].tolist() == skeleton.label.tolist()
    assert np.array_equal(vertex["radius"], np.nan_to_num(skeleton.radius))


@pytest.mark.parametrize("ending", FORMATS)
def test_a_base_alone_is_written_as_what_holds_nodes_and_refused_as_wood(
    ending: str, tmp_path: Path
) -> None:
    write_skeleton(tmp_path / "s.json", tree("o"))
    target = tmp_path / f"t{ending}"
    if ending in LINES:
        convert_file(tmp_path / "s.json", target)
        assert target.stat().st_size > 20
    else:
        with pytest.raises(PrunusError, match=r"s.json: holds a base alone"):
            convert_file(tmp_path / "s.json", target)
        assert not target.exists()


def full(skeleton: Skeleton) -> Skeleton:
    """A skeleton that knows everything of itself."""
    rows = len(skeleton)
    return Skeleton.build(
        skeleton.xyz, skeleton.parent, skeleton.label,
        confidence=np.full(rows, 0.5), radius=np.full(rows, 0.01), superpoint=np.arange(rows),
    )  # fmt: skip


@pytest.mark.parametrize(
    ("ending", "lost"),
    [
        (".json", ""), (".graphml", ""), (".mtg", "superpoint"), (".cylinders.csv", "superpoint"),
        (".swc", "confidence, superpoint"), (".ply", "confidence, superpoint"),
        (".dxf", "confidence, superpoint, radius"), (".mcap", "confidence, superpoint"),
        (".treeqsm.csv", "confidence, superpoint, label"), (".glb", "confidence, superpoint"),
    ],
)  # fmt: skip
def test_what_has_no_place_is_said(ending: str, lost: str, tmp_path: Path) -> None:
    write_skeleton(tmp_path / "s.json", full(tree()))
    notes = convert_file(tmp_path / "s.json", tmp_path / f"t{ending}")
    told = [note for note in notes if note.startswith("left out")]
    assert told == ([f"left out, as there is no place for it: {lost}"] if lost else [])
