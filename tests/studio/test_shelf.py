from pathlib import Path

import pytest

from prunus.errors import PrunusError
from prunus.io.skeletons.skeleton_file import write_skeleton
from prunus.studio.shelf import items_in
from tests.drawn import tree


def touch(path: Path) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("x")
    return path


def test_a_folder_holds_its_clouds_and_the_skeletons_below_it(tmp_path: Path) -> None:
    touch(tmp_path / "in" / "b.ply")
    touch(tmp_path / "in" / "a.xyz")
    write_skeleton(tmp_path / "in" / "old" / "skeleton.json", tree())
    touch(tmp_path / "in" / "notes.txt.bak")
    items = items_in(tmp_path / "in", tmp_path / "work")
    assert [item.name for item in items] == ["a", "b", "old"]
    assert [item.folder.name for item in items] == ["a", "b", "old"]
    assert items[2].source == tmp_path / "in" / "old" / "skeleton.json"


def test_a_cloud_goes_before_a_skeleton_of_its_name(tmp_path: Path) -> None:
    cloud = touch(tmp_path / "in" / "a.ply")
    touch(tmp_path / "in" / "a" / "skeleton.json")
    assert [item.source for item in items_in(tmp_path / "in", tmp_path / "work")] == [cloud]


def test_a_file_is_a_shelf_of_one(tmp_path: Path) -> None:
    skeleton = touch(tmp_path / "tree_7" / "skeleton.json")
    assert [item.name for item in items_in(skeleton, tmp_path / "work")] == ["tree_7"]
    assert [item.name for item in items_in(touch(tmp_path / "x.las"), tmp_path)] == ["x"]


def test_the_work_is_not_kept_upon_what_it_is_about(tmp_path: Path) -> None:
    skeleton = touch(tmp_path / "tree_7" / "skeleton.json")
    with pytest.raises(PrunusError, match="would be kept"):
        items_in(skeleton, tmp_path)


def test_the_folder_of_a_tree_that_was_worked_on_is_that_tree(tmp_path: Path) -> None:
    for name in ("skeleton.json", "journal.jsonl", "graph.npz", "mask.ply"):
        (tmp_path / "work" / "oak").mkdir(parents=True, exist_ok=True)
        (tmp_path / "work" / "oak" / name).write_text("x")
    (item,) = items_in(tmp_path / "work" / "oak", tmp_path / "again")
    assert item.name == "oak" and item.source.name == "skeleton.json"


def test_an_empty_folder_holds_nothing_to_open(tmp_path: Path) -> None:
    with pytest.raises(PrunusError, match="no point cloud"):
        items_in(tmp_path, tmp_path / "work")


def test_a_path_that_is_not_there_is_said(tmp_path: Path) -> None:
    with pytest.raises(PrunusError, match="cannot be read"):
        items_in(tmp_path / "gone.ply", tmp_path / "work")
