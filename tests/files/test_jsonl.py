"""Files that only grow: what a machine that dies leaves, and what an editor leaves."""

import json
from pathlib import Path

import pytest

from prunus.errors import PrunusError
from prunus.files.jsonl import append_at, append_line, ended, read_lines_of, whole_lines

ONE, TWO = {"a": 1}, {"b": [2, "zwei\n"]}
BOTH = (json.dumps(ONE) + "\n" + json.dumps(TWO) + "\n").encode()


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "some.jsonl"


@pytest.mark.parametrize("cut", range(1, len(BOTH)))
def test_a_file_cut_anywhere_keeps_what_is_whole_and_goes_on(path: Path, cut: int) -> None:
    path.write_bytes(BOTH[:-cut])
    kept = [line for _, line in read_lines_of(path)]
    assert kept == [ONE, TWO][: len(kept)]
    assert len(kept) == (2 if cut == 1 else 1 if cut <= len(json.dumps(TWO)) + 2 else 0)
    append_at(path, ended(path), TWO)
    assert [line for _, line in read_lines_of(path)] == [*kept, TWO]


def test_a_first_line_is_written_once(path: Path) -> None:
    for line in (ONE, TWO):
        append_line(path, line, first={"head": True})
    assert read_lines_of(path) == [(1, {"head": True}), (2, ONE), (3, TWO)]


def test_blank_lines_are_no_lines() -> None:
    assert whole_lines(b"") == whole_lines(b"\n \n") == []
    assert whole_lines(BOTH + b"\n\n") == BOTH.splitlines()


def test_who_wrote_meanwhile_is_not_overwritten(path: Path) -> None:
    path.write_bytes(BOTH)
    with pytest.raises(PrunusError, match="another process wrote"):
        append_at(path, len(BOTH) - 3, ONE)
    assert path.read_bytes() == BOTH


@pytest.mark.parametrize("line", ["[1]", "3", "{'a': 1}"])
def test_a_line_that_is_no_object_is_told_by_file_and_line(path: Path, line: str) -> None:
    path.write_text(f"{json.dumps(ONE)}\n{line}\n")
    with pytest.raises(PrunusError, match=r"some\.jsonl: line 2: "):
        read_lines_of(path)
