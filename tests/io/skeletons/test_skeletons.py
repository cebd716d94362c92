"""Skeletons to files and back; the schema; files that lie."""

import json
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prunus.errors import PrunusError
from prunus.io.ply import read_ply
from prunus.io.skeletons.export import write_ply
from prunus.io.skeletons.skeleton_file import read_record, read_skeleton, write_skeleton
from prunus.model import Skeleton
from prunus.schemas import schema
from tests.drawn import tree


def random_skeleton(seed: int) -> Skeleton:
    rng = np.random.default_rng(seed)
    rows = int(rng.integers(1, 20))
    parent = [-1, *(int(rng.integers(0, row)) for row in range(1, rows))]
    radius = np.where(rng.random(rows) < 0.5, np.nan, rng.random(rows) + 1e-3)
    return Skeleton.build(
        rng.normal(size=(rows, 3)) * 1e3,
        parent,
        rng.integers(0, 4, rows),
        confidence=np.where(rng.random(rows) < 0.5, np.nan, rng.random(rows)),
        radius=radius,
        superpoint=rng.integers(-1, 500, rows),
    )


def same(first: Skeleton, second: Skeleton, *columns: str) -> bool:
    return all(
        np.array_equal(getattr(first, name), getattr(second, name), equal_nan=True)
        for name in columns
    )


@settings(deadline=None, max_examples=30)
@given(seed=st.integers(0, 10_000))
def test_json_gives_back_every_bit(tmp_path_factory: pytest.TempPathFactory, seed: int) -> None:
    skeleton = random_skeleton(seed)
    path = tmp_path_factory.mktemp("json") / "skeleton.json"
    write_skeleton(path, skeleton, score=1.5, seed=seed)
    back, record = read_record(path)
    columns = ("xyz", "parent", "label", "confidence", "radius", "superpoint")
    assert same(back, skeleton, *columns)
    assert (record.score, record.seed) == (1.5, seed)
    jsonschema.validate(json.loads(path.read_text()), schema("skeleton"))


def test_ply_holds_coloured_edges_and_named_columns(tmp_path: Path) -> None:
    skeleton = tree()
    write_ply(tmp_path / "s.ply", skeleton)
    tables = read_ply((tmp_path / "s.ply").read_bytes(), tmp_path / "s.ply", ("vertex", "edge"))
    edges = np.column_stack([tables["edge"]["vertex1"], tables["edge"]["vertex2"]])
    assert edges.tolist() == skeleton.edges.tolist()
    assert tables["vertex"]["label"].tolist() == skeleton.label.tolist()
    assert len(np.unique(tables["edge"][["red", "green", "blue"]])) == 4


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"format": "other"}, "format: "),
        ({"version": 3}, "version: "),
        ({"label": ["trunk", "twig"]}, r"label\.1: "),
        ({"parent": [-1]}, "parent: 1 entries; expected one for each of the 2 nodes"),
        ({"parent": [-1, 1]}, r"parent\[1\] is 1"),
        ({"nodes": [[0, 0], [1, 1]]}, r"nodes\.0"),
        ({"nodes": []}, "nodes: "),
        ({"branch": [-1, 3]}, "branch: 3 at node 1; expected 0, by parents and labels"),
        ({"seen": [True]}, "seen: 1 entries"),
        ({"colour": "red"}, "colour: unknown field; expected one of branch, branches, conf"),
    ],
)
def test_a_file_that_lies_is_refused_by_field(tmp_path: Path, change: dict, message: str) -> None:
    path = tmp_path / "s.json"
    write_skeleton(path, tree("t\no"))
    path.write_text(json.dumps(json.loads(path.read_text()) | change))
    with pytest.raises(PrunusError, match=f"s.json: {message}"):
        read_skeleton(path)


def test_a_file_of_version_1_is_read(tmp_path: Path) -> None:
    path = tmp_path / "s.json"
    write_skeleton(path, tree())
    held = json.loads(path.read_text())
    for name in ("branch", "radius_error", "seen", "read"):
        del held[name]
    path.write_text(json.dumps(held | {"version": 1}))
    skeleton, record = read_record(path)
    assert skeleton.parent.tolist() == tree().parent.tolist() and record.version == 1
