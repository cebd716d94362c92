"""What a path on the command line stands for, and what its outputs are called."""

import os
from pathlib import Path

import pytest

from prunus.errors import PrunusError
from prunus.io.inputs import Source, clouds_in, is_bag, is_one, names_of, source_of, tree_in


def touched(folder: Path, *names: str) -> Path:
    """A folder with these files, each with a byte in it; a recording's metadata looks like one."""
    for name in names:
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("rosbag2_bagfile_information:" if path.suffix == ".yaml" else "x")
    return folder


def test_the_data_set_is_one_cloud_a_folder(tmp_path: Path) -> None:
    clouds = ("cloud_final.ply", "top_cloud.ply", "bottom_cloud.ply")
    touched(tmp_path, *(f"bag_{tree}/{name}" for tree in (0, 1) for name in clouds))
    inside = clouds_in(tmp_path)
    assert inside == [tmp_path / f"bag_{tree}" / "cloud_final.ply" for tree in (0, 1)]
    assert names_of(inside) == ["bag_0", "bag_1"]
    assert clouds_in(tmp_path / "bag_1") == inside[1:]
    assert is_one(tmp_path / "bag_1") and not is_one(tmp_path)
    assert source_of(tmp_path / "bag_1") == Source(inside[1])


def test_an_orchard_of_scans_is_one_scan_a_folder(tmp_path: Path) -> None:
    trees = ("tree_000000", "tree_000001")
    touched(tmp_path, *(f"{t}/{name}" for t in trees for name in ("scan.ply", "trees.npz")))
    inside = clouds_in(tmp_path)
    assert inside == [tmp_path / tree / "scan.ply" for tree in trees]
    assert names_of(inside) == list(trees)


def test_a_scan_without_truth_beside_it_stands_for_itself(tmp_path: Path) -> None:
    touched(tmp_path, "scan.ply", "tree2.ply", "notes.md", "more/tree.ply")
    assert tree_in(tmp_path) is None
    assert clouds_in(tmp_path) == [tmp_path / "scan.ply", tmp_path / "tree2.ply"]


def test_what_the_studio_keeps_beside_a_journal_is_no_scan(tmp_path: Path) -> None:
    kept = ("mask.ply", "graph.npz", "graph-12.npz")
    assert clouds_in(touched(tmp_path / "scans", *kept)) == [
        tmp_path / "scans" / name for name in sorted(kept)
    ]
    assert clouds_in(touched(tmp_path / "work", *kept, "journal.jsonl", "own.ply")) == [
        tmp_path / "work" / "own.ply"
    ]


def test_recordings_lie_in_a_folder_like_clouds(tmp_path: Path) -> None:
    touched(tmp_path, "a.bag", "b.ply", "c/metadata.yaml", "c/c_0.mcap", "d/x.mcap", "E.MCAP")
    assert [path.name for path in clouds_in(tmp_path)] == ["E.MCAP", "a.bag", "b.ply", "c"]
    assert clouds_in(tmp_path / "c") == [tmp_path / "c"]
    assert clouds_in(tmp_path / "d") == [tmp_path / "d" / "x.mcap"]


def test_metadata_of_something_else_makes_no_recording(tmp_path: Path) -> None:
    touched(tmp_path, "tree.ply")
    (tmp_path / "metadata.yaml").write_text("author: someone")
    assert not is_bag(tmp_path) and clouds_in(tmp_path) == [tmp_path / "tree.ply"]


@pytest.mark.parametrize(
    ("path", "bag", "topic"),
    [
        ("a.bag#/points", "a.bag", "/points"),
        ("a.bag#points", "a.bag", "points"),
        ("rec#/left/points", "rec", "/left/points"),
        ("row#7/b.mcap#/points", "row#7/b.mcap", "/points"),
        ("row#7/b.mcap", "row#7/b.mcap", None),
        ("a.bag#1.ply", "a.bag#1.ply", None),
        ("a.bag#2.bag#/points", "a.bag#2.bag", "/points"),
        ("none.bag#/points", "none.bag", "/points"),
        ("tree.ply#/points", "tree.ply#/points", None),
        ("a.bag#", "a.bag#", None),
        ("none", "none", None),
    ],
)
def test_a_topic_stands_behind_a_mark_unless_a_file_is_called_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, path: str, bag: str, topic: str | None
) -> None:
    monkeypatch.chdir(tmp_path)
    touched(tmp_path, "a.bag", "rec/metadata.yaml", "row#7/b.mcap", "a.bag#1.ply", "tree.ply")
    touched(tmp_path, "a.bag#2.bag")
    assert source_of(Path(path)) == Source(Path(bag), topic)
    assert source_of(Path(path)).full == Path(path)


@pytest.mark.parametrize(
    ("paths", "names"),
    [
        (["a/tree.ply", "b/other.ply"], ["tree", "other"]),
        (["a/tree.ply", "b/tree.ply"], ["a", "b"]),
        (["a/1.ply", "a/2.ply", "b/1.ply", "b/2.ply"], ["a_1", "a_2", "b_1", "b_2"]),
        (["a/1.ply", "a/1.pcd"], ["a_1", "a_1"]),
        (["a/t0/scan.ply", "b/t0/scan.ply"], ["a", "b"]),
        (["r.bag#/left", "r.bag#/right/up", "s.bag#/left"], ["r_left", "r_right_up", "s"]),
        (["scan.ply", "tree.ply"], ["scan", "tree"]),
        (["../tree.ply", "tree.ply"], ["here", "in"]),
    ],
)
def test_names_are_short_where_they_can_be_and_never_shared(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, paths: list[str], names: list[str]
) -> None:
    (tmp_path / "here" / "in").mkdir(parents=True)
    monkeypatch.chdir(tmp_path / "here" / "in")
    assert names_of([Path(path) for path in paths]) == names


def test_what_cannot_be_looked_at_is_a_plain_error() -> None:
    with pytest.raises(PrunusError, match=r"cannot be read \(File name too long\)"):
        source_of(Path("n" * 300 + ".ply"))
    assert not is_bag(Path("n" * 300)) and tree_in(Path("n" * 300)) is None


@pytest.mark.parametrize(
    "name", [".DS_Store", "._tree.ply", ".tree.ply", ".trash.mcap", ".Trashes/metadata.yaml",
             "._bag/scan.ply", ".hidden.txt"],
)  # fmt: skip
def test_hidden_files_and_folders_are_no_scans(tmp_path: Path, name: str) -> None:
    touched(tmp_path, name, "tree.ply")
    touched(tmp_path, "._bag/trees.npz")
    assert clouds_in(tmp_path) == [tmp_path / "tree.ply"]
    assert source_of(tmp_path) == Source(tmp_path / "tree.ply")


@pytest.mark.parametrize(
    ("text", "scan"),
    [
        ("Scanned in May.\nBy hand, at 5 m.\n", False),
        ("tree,variety\n1,Envy\n2,Gala\n", False),
        ("tree,girth\n1,30.5\n", False),
        ("1 2 3\n", True),
        ("1;2;3\n", True),
        ("1,5 2,5 3,5\n", True),
        ("# exported\n//X Y Z\n", True),
        ("x,y,z,class\n", True),
        ("oak;1;2;3\n", False),
        ("", True),
    ],
)
@pytest.mark.parametrize("ending", [".txt", ".csv", ".asc"])
def test_notes_and_tables_beside_scans_are_none(
    tmp_path: Path, text: str, scan: bool, ending: str
) -> None:
    touched(tmp_path, "tree.ply")
    (tmp_path / f"a{ending}").write_text(text)
    assert (tmp_path / f"a{ending}" in clouds_in(tmp_path)) == scan


def test_links_that_lead_nowhere_are_inputs_that_fail(tmp_path: Path) -> None:
    touched(tmp_path, "tree.ply")
    (tmp_path / "gone.ply").symlink_to(tmp_path / "none.ply")
    (tmp_path / "loop.ply").symlink_to(tmp_path / "loop.ply")
    (tmp_path / "round").symlink_to(tmp_path)
    assert [path.name for path in clouds_in(tmp_path)] == ["gone.ply", "loop.ply", "tree.ply"]


def test_what_is_no_file_is_no_input(tmp_path: Path) -> None:
    touched(tmp_path, "tree.ply")
    (tmp_path / "folder.ply").mkdir()
    for name in ("pipe.ply", "pipe.txt", "metadata.yaml"):
        os.mkfifo(tmp_path / name)
    assert clouds_in(tmp_path) == [tmp_path / "tree.ply"]


def test_a_folder_of_one_bag_or_tree_stands_for_it(tmp_path: Path) -> None:
    touched(
        tmp_path, "row/rec/metadata.yaml", "trees/t0/scan.ply", "trees/t0/trees.npz", "two/a.ply"
    )
    touched(tmp_path, "two/b.ply", "none/notes.md")
    assert source_of(tmp_path / "row") == Source(tmp_path / "row" / "rec")
    assert source_of(tmp_path / "trees") == Source(tmp_path / "trees" / "t0" / "scan.ply")
    for several in ("two", "none"):
        assert source_of(tmp_path / several) == Source(tmp_path / several)
