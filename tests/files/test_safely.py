"""Files are written whole or not at all, and nothing is waited for that may never come."""

import errno
import os
from pathlib import Path
from typing import Any

import pytest

from prunus.errors import PrunusError
from prunus.files.safely import (
    check_readable,
    digest_of,
    read_bytes,
    write_bytes,
    written_together,
)
from prunus.io.clouds.cloud_file import read_cloud

posix = pytest.mark.skipif(os.name != "posix", reason="pipes and devices have names on POSIX alone")


def everything_in(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.mark.parametrize("name", ["a.json", "n" * 250 + ".json", "桃" * 80 + ".swc", ".hidden"])
def test_any_legal_name_is_written(name: str, tmp_path: Path) -> None:
    write_bytes(tmp_path / "new" / name, b"first")
    write_bytes(tmp_path / "new" / name, b"second")
    assert everything_in(tmp_path / "new") == {name: b"second"}


@pytest.mark.parametrize(
    "error", [OSError(errno.ENOSPC, "full"), KeyboardInterrupt(), SystemExit()]
)
def test_what_is_interrupted_leaves_the_older_file_and_nothing_else(
    error: BaseException, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stopped(*_: Any) -> None:
        raise error

    write_bytes(tmp_path / "a.json", b"old")
    monkeypatch.setattr(Path, "replace", stopped)
    with pytest.raises(PrunusError if isinstance(error, OSError) else type(error)):
        write_bytes(tmp_path / "a.json", b"new")
    assert everything_in(tmp_path) == {"a.json": b"old"}


@posix
def test_a_link_stays_a_link(tmp_path: Path) -> None:
    (tmp_path / "latest.json").symlink_to("a.json")
    write_bytes(tmp_path / "latest.json", b"new")
    assert (tmp_path / "latest.json").is_symlink()
    assert (tmp_path / "a.json").read_bytes() == b"new"


@posix
@pytest.mark.parametrize("kind", ["pipe", "device"])
def test_pipes_and_devices_are_neither_read_nor_replaced(kind: str, tmp_path: Path) -> None:
    path = tmp_path / "tree.ply"
    if kind == "pipe":
        os.mkfifo(path)
    else:
        path.symlink_to(os.devnull)
    for use in (read_bytes, check_readable, read_cloud, lambda path: write_bytes(path, b"x")):
        with pytest.raises(PrunusError, match=r"tree\.ply: a pipe or a device; expected a file"):
            use(path)
    assert not path.is_file()


def test_a_folder_with_a_pipe_has_a_digest(tmp_path: Path) -> None:
    (tmp_path / "a").write_text("a")
    before = digest_of(tmp_path)
    if os.name == "posix":
        os.mkfifo(tmp_path / "pipe")
    assert digest_of(tmp_path) == before


def test_files_that_belong_together_come_together_the_last_one_last(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder, order, replace = tmp_path / "out", list[str](), Path.replace

    def seen(path: Path, target: Path) -> Path:
        if target.parent == folder:
            order.append(target.name)
        return replace(path, target)

    monkeypatch.setattr(Path, "replace", seen)
    with written_together(folder, "b.json") as together:
        for name in ("a.swc", "b.json", "c.ply"):
            write_bytes(together / name, b"new")
        assert [path for path in folder.iterdir() if not path.name.startswith(".")] == []
    assert set(everything_in(folder)) == {"a.swc", "b.json", "c.ply"} == set(order)
    assert order[-1] == "b.json"


@pytest.mark.parametrize("where", ["while they are written", "while they come"])
def test_a_run_that_fails_leaves_no_folder_that_looks_whole(
    where: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_bytes(tmp_path / "whole.json", b"old")
    replace = Path.replace

    def stopped(path: Path, target: Path) -> Path:
        if target == tmp_path / "other.json":
            raise KeyboardInterrupt
        return replace(path, target)

    monkeypatch.setattr(Path, "replace", stopped)
    with (
        pytest.raises((KeyboardInterrupt, PrunusError)),
        written_together(tmp_path, "whole.json") as together,
    ):
        write_bytes(together / "whole.json", b"new")
        write_bytes(together / "other.json", b"new")
        if where == "while they are written":
            raise PrunusError(f"{together}/x: the disk is full")
    assert everything_in(tmp_path) == ({"whole.json": b"old"} if "written" in where else {})


def test_what_an_older_run_wrote_goes_where_no_new_one_comes(tmp_path: Path) -> None:
    for name in ("page.html", "table.csv", "whole.json", "journal.jsonl"):
        write_bytes(tmp_path / name, b"old")
    with written_together(tmp_path, "whole.json", ["page.html", "table.csv", "none"]) as together:
        write_bytes(together / "whole.json", b"new")
        write_bytes(together / "table.csv", b"new")
    new = {"whole.json": b"new", "table.csv": b"new"}
    assert everything_in(tmp_path) == new | {"journal.jsonl": b"old"}


def test_an_error_names_the_folder_that_was_asked_for(tmp_path: Path) -> None:
    with (
        pytest.raises(PrunusError) as told,
        written_together(tmp_path / "out", "a") as together,
    ):
        raise PrunusError(f"{together / 'a'}: cannot be written")
    assert str(told.value) == f"{tmp_path / 'out' / 'a'}: cannot be written"
