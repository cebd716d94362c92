"""Edges as cylinders: the tables of SimpleForest, TreeQSM and raycloudtools."""

import csv
from collections import Counter
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prunus.io.skeletons.cylinders import Cylinders, write_cylinders, write_treeqsm
from prunus.io.skeletons.treetext import write_treetext
from prunus.model import Label, Skeleton
from tests.drawn import tree
from tests.io.skeletons.test_skeletons import random_skeleton


@pytest.fixture
def skeleton() -> Skeleton:
    drawn = tree()
    return drawn.with_radius(np.linspace(0.03, 0.01, len(drawn)))


def rows_of(path: Path) -> list[dict[str, Any]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def test_a_cylinder_has_the_mean_radius_save_where_a_branch_starts(skeleton: Skeleton) -> None:
    made = Cylinders.of(skeleton)
    radius, parent = skeleton.radius, skeleton.parent
    assert made.radius[0] == pytest.approx(radius[1])
    assert made.radius[1] == pytest.approx((radius[1] + radius[2]) / 2)
    support = int(np.flatnonzero(skeleton.label == Label.SUPPORT)[0])
    assert parent[support] == 2
    assert made.radius[support - 1] == pytest.approx(radius[support])


def test_simpleforest_columns_hold_the_tree(skeleton: Skeleton, tmp_path: Path) -> None:
    write_cylinders(tmp_path / "t.cylinders.csv", skeleton)
    rows = rows_of(tmp_path / "t.cylinders.csv")
    assert [int(row["ID"]) for row in rows] == list(range(len(skeleton) - 1))
    for row in rows:
        start = np.array([float(row[f"start{axis}"]) for axis in "XYZ"])
        end = np.array([float(row[f"end{axis}"]) for axis in "XYZ"])
        assert np.linalg.norm(end - start) == pytest.approx(float(row["length"]), abs=2e-6)
        assert int(row["branchOrder"]) == Label.from_word(row["label"])
        if row["parentID"] != "-1":
            before = rows[int(row["parentID"])]
            assert [before[f"end{axis}"] for axis in "XYZ"] == [
                row[f"start{axis}"] for axis in "XYZ"
            ]
    assert [row["ID"] for row in rows if row["parentID"] == "-1"] == ["0"]
    assert {row["confidence"] for row in rows} == {""}


RTWIG = [
    "ID", "parentID", "startX", "startY", "startZ", "endX", "endY", "endZ", "radius", "length",
    "branchOrder", "branchID", "segmentID", "parentSegmentID",
]  # fmt: skip
"""What rTwig's update_cylinders() asks of a table of SimpleForest."""
ARCHI = [
    "radius", "length", "start.x", "start.y", "start.z", "axis.x", "axis.y", "axis.z", "parent",
    "extension", "added", "UnmodRadius", "branch", "BranchOrder", "PositionInBranch",
]  # fmt: skip
"""The columns of TreeQSM in the order in which aRchi's read_QSM() names them anew."""


def test_rtwig_and_archi_find_the_columns_that_they_ask_for(
    skeleton: Skeleton, tmp_path: Path
) -> None:
    write_cylinders(tmp_path / "t.cylinders.csv", skeleton)
    write_treeqsm(tmp_path / "t.treeqsm.csv", skeleton)
    assert list(rows_of(tmp_path / "t.cylinders.csv")[0])[: len(RTWIG)] == RTWIG
    rows = rows_of(tmp_path / "t.treeqsm.csv")
    assert list(rows[0]) == ARCHI
    for row in rows:
        for column in ("parent", "extension", "added", "branch", "BranchOrder"):
            assert row[column].isdigit()
        for column in ("radius", "length", "axis.x", "UnmodRadius"):
            assert np.isfinite(float(row[column]))


@settings(deadline=None, max_examples=40)
@given(seed=st.integers(0, 10_000))
def test_a_segment_is_what_of_a_branch_lies_between_two_forks(
    tmp_path_factory: pytest.TempPathFactory, seed: int
) -> None:
    skeleton = random_skeleton(seed)
    if len(skeleton) == 1:
        return
    path = tmp_path_factory.mktemp("csv") / "t.cylinders.csv"
    write_cylinders(path, skeleton)
    rows = rows_of(path)
    whole = [{name: int(row[name]) for name in RTWIG if "ID" in name} for row in rows]
    on_it = Counter(row["parentID"] for row in whole)
    for row in whole:
        carrier = None if row["parentID"] < 0 else whole[row["parentID"]]
        goes_on = (
            carrier is not None
            and on_it[row["parentID"]] == 1
            and carrier["branchID"] == row["branchID"]
        )
        if goes_on:
            assert carrier is not None and row["segmentID"] == carrier["segmentID"]
        else:
            assert sum(one["segmentID"] == row["segmentID"] for one in whole[: row["ID"]]) == 0
            above = -1 if carrier is None else carrier["segmentID"]
            assert row["parentSegmentID"] == above
    assert sorted({row["segmentID"] for row in whole}) == list(
        range(1 + max(row["segmentID"] for row in whole))
    )


def test_treeqsm_columns_chain_each_branch(skeleton: Skeleton, tmp_path: Path) -> None:
    write_treeqsm(tmp_path / "t.treeqsm.csv", skeleton)
    rows = rows_of(tmp_path / "t.treeqsm.csv")
    assert rows[0]["parent"] == "0"
    for number in {row["branch"] for row in rows}:
        chain = [row for row in rows if row["branch"] == number]
        assert [int(row["PositionInBranch"]) for row in chain] == list(range(1, len(chain) + 1))
        for row, after in pairwise(chain):
            assert rows[int(row["extension"]) - 1] is after
            assert rows[int(after["parent"]) - 1] is row
        assert chain[-1]["extension"] == "0"
    axes = np.array([[float(row[f"axis.{axis}"]) for axis in "xyz"] for row in rows])
    assert np.linalg.norm(axes, axis=1) == pytest.approx(1, abs=1e-5)


def test_the_tree_text_is_one_line_of_segments(skeleton: Skeleton, tmp_path: Path) -> None:
    write_treetext(tmp_path / "t.txt", skeleton)
    comment, head, line = (tmp_path / "t.txt").read_text().splitlines()
    assert comment.startswith("#")
    assert head.startswith("x,y,z,radius,parent_id,")
    values = np.array(line.split(","), float).reshape(-1, len(head.split(",")))
    assert values[:, :3] == pytest.approx(skeleton.xyz, abs=1e-6)
    assert values[:, 3] == pytest.approx(skeleton.radius, abs=1e-6)
    assert values[:, 4].tolist() == skeleton.parent.tolist()
    assert line.count(", ") == len(skeleton) - 1
