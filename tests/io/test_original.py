"""Where the scan of a work folder is looked for."""

from pathlib import Path

import pytest

from prunus.errors import PrunusError
from prunus.files.safely import digest_of
from prunus.io.original import original_of
from prunus.io.skeletons.skeleton_file import InputRecord


def record(path: Path) -> InputRecord:
    return InputRecord(file=path.name, sha256=digest_of(path), points=1)


def put(path: Path, text: str = "1 2 3") -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return path


@pytest.mark.parametrize(
    "where",
    ["studio/tree", "studio", ".", "scans", "orchard/tree", "elsewhere"],
)
def test_a_scan_is_found_beside_above_and_where_one_works(
    where: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(put(tmp_path / "home" / "x").parent)
    scan = put(tmp_path / where / "scan.ply")
    folder = tmp_path / "studio" / "tree"
    scans = tmp_path / "elsewhere" if where == "elsewhere" else None
    found = original_of(record(scan), folder, scans)
    assert found.resolve() == scan


def test_one_of_the_same_name_with_other_contents_is_passed_over(tmp_path: Path) -> None:
    wanted = record(put(tmp_path / "b" / "tree" / "scan.ply", "wanted"))
    other = put(tmp_path / "a" / "tree" / "scan.ply", "other")
    folder = tmp_path / "studio" / "tree"
    assert original_of(wanted, folder, tmp_path).parts[-3:] == ("b", "tree", "scan.ply")
    (tmp_path / "b" / "tree" / "scan.ply").unlink()
    with pytest.raises(PrunusError, match="sha256 is another") as caught:
        original_of(wanted, folder, tmp_path)
    assert str(other) in str(caught.value)


@pytest.mark.parametrize(
    ("name", "told"),
    [("gone.ply", "--scans"), ("../scan.ply", "name of a file"), ("sub/scan.ply#t", "name of")],
)
def test_what_is_not_there_or_is_no_name_is_told(tmp_path: Path, name: str, told: str) -> None:
    put(tmp_path / "sub" / "scan.ply")
    wanted = InputRecord(file=name, sha256="0", points=1)
    with pytest.raises(PrunusError, match=told):
        original_of(wanted, tmp_path / "studio" / "tree", tmp_path / "sub")


def test_a_topic_stays_with_its_bag(tmp_path: Path) -> None:
    bag = put(tmp_path / "row.mcap")
    wanted = InputRecord(file="row.mcap#/points", sha256=digest_of(bag), points=1)
    assert str(original_of(wanted, tmp_path, tmp_path)) == f"{bag}#/points"
