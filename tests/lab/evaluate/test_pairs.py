"""`prunus evaluate`: pairs, folders, formats, and what is wrong with them."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from prunus.cli import app
from prunus.io.skeletons.export import write_ply
from prunus.io.skeletons.skeleton_file import write_skeleton
from prunus.io.skeletons.swc import write_swc
from tests.drawn import TREE, tree

RUN = CliRunner()
BARE = TREE.replace("l   lb l", "l   l  l")


def test_a_pair_with_labels(tmp_path: Path) -> None:
    write_skeleton(tmp_path / "found.json", tree(BARE))
    write_skeleton(tmp_path / "gold.json", tree())
    done = RUN.invoke(
        app, ["evaluate", str(tmp_path / "found.json"), str(tmp_path / "gold.json"), "--json"]
    )
    assert done.exit_code == 0
    held = json.loads(done.stdout)
    assert held["labels"] is True
    assert held["leader_recall"] == 1
    assert held["side_branches_found"] == 0
    assert "edit_ratio" not in held, "they stand on no superpoints"


def test_on_the_same_superpoints_the_edits_are_counted(tmp_path: Path) -> None:
    whole = replace(tree(), superpoint=np.arange(len(tree())))
    kept = np.ones(len(whole), bool)
    kept[-1] = False
    write_skeleton(tmp_path / "found.json", whole.part(kept))
    write_skeleton(tmp_path / "gold.json", whole)
    done = RUN.invoke(
        app, ["evaluate", str(tmp_path / "found.json"), str(tmp_path / "gold.json"), "--json"]
    )
    held = json.loads(done.stdout)
    assert (held["wrong"], held["missing"], held["mislabelled"]) == (0, 1, 0)
    assert held["edit_ratio"] == pytest.approx(1 / (len(whole) - 1))


def test_other_tools_are_measured_by_geometry(tmp_path: Path) -> None:
    write_ply(tmp_path / "found.ply", tree())
    write_swc(tmp_path / "gold.swc", tree())
    done = RUN.invoke(app, ["evaluate", str(tmp_path / "found.ply"), str(tmp_path / "gold.swc")])
    assert done.exit_code == 0
    assert "geometry_recall" in done.stdout
    assert "leader" not in done.stdout


@pytest.mark.parametrize(("aside", "apart"), [(0.0, False), (0.03, False), (3.0, True)])
def test_two_trees_that_have_nothing_in_common_are_no_comparison(
    aside: float, apart: bool, tmp_path: Path
) -> None:
    write_skeleton(tmp_path / "gold.json", tree())
    write_skeleton(
        tmp_path / "found.json", replace(tree(), xyz=tree().xyz + np.array([aside, 0, 0]))
    )
    words = ["evaluate", str(tmp_path / "found.json"), str(tmp_path / "gold.json"), "--json"]
    done = RUN.invoke(app, words)
    assert done.exit_code == (1 if apart else 0)
    assert json.loads(done.stdout)["labels"]
    assert ("nothing of one lies by the other" in done.stderr) == apart


def test_two_folders(tmp_path: Path) -> None:
    for name in ("a", "b"):
        write_skeleton(tmp_path / "out" / name / "skeleton.json", tree(BARE))
        write_skeleton(tmp_path / "gold" / name / "truth.json", tree())
    table = tmp_path / "table.csv"
    words = ["evaluate", str(tmp_path / "out"), str(tmp_path / "gold"), "--csv", str(table)]
    done = RUN.invoke(app, words)
    assert done.exit_code == 0
    assert [row.split(",")[0] for row in table.read_text().splitlines()] == ["name", "a", "b"]
    (tmp_path / "out" / "b" / "skeleton.json").unlink()
    done = RUN.invoke(app, words)
    assert done.exit_code == 1
    assert "no skeleton 'b'" in done.output


def test_what_a_person_corrected_is_the_gold_standard_of_the_same_folder(tmp_path: Path) -> None:
    whole = replace(tree(), superpoint=np.arange(len(tree())))
    kept = np.ones(len(whole), bool)
    kept[-1] = False
    for name in ("a", "new"):
        write_skeleton(tmp_path / name / "skeleton.json", whole)
    write_skeleton(tmp_path / "a" / "corrected.json", whole.part(kept))
    done = RUN.invoke(app, ["evaluate", str(tmp_path), str(tmp_path), "--json"])
    assert done.exit_code == 0
    held = [json.loads(line) for line in done.stdout.splitlines()]
    assert [one["name"] for one in held] == ["a"], "the other was not corrected"
    assert (held[0]["wrong"], held[0]["missing"]) == (1, 0)


def test_points_that_a_person_added_count_as_missing(tmp_path: Path) -> None:
    """They stand on no superpoint: each is its own."""
    whole = tree()
    known = np.arange(len(whole))
    kept = known < len(whole) - 2
    write_skeleton(tmp_path / "found.json", replace(whole, superpoint=known).part(kept))
    free = replace(whole, superpoint=np.where(kept, known, -1))
    write_skeleton(tmp_path / "gold.json", free)
    done = RUN.invoke(
        app, ["evaluate", str(tmp_path / "found.json"), str(tmp_path / "gold.json"), "--json"]
    )
    held = json.loads(done.stdout)
    assert (held["wrong"], held["missing"], held["mislabelled"]) == (0, 2, 0)
    assert held["edit_ratio"] == pytest.approx(2 / (len(whole) - 1))


@pytest.mark.parametrize(
    ("found", "says"),
    [("missing.json", "cannot be read"), ("gold.stl", "expected one of"), (".", "two files")],
)
def test_bad_input_is_named(tmp_path: Path, found: str, says: str) -> None:
    write_skeleton(tmp_path / "gold.json", tree())
    (tmp_path / "gold.stl").write_text("solid")
    done = RUN.invoke(app, ["evaluate", str(tmp_path / found), str(tmp_path / "gold.json")])
    assert done.exit_code == 1
    assert says in done.output.replace("\n", " ")
