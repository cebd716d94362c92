"""The journal: reading gives what was written; what is wrong is told by line, and left alone."""

import json
from pathlib import Path

import pytest

from prunus.editing import RemoveEdge, SetStatus
from prunus.errors import PrunusError
from prunus.files.work_folder import JOURNAL
from prunus.params import Parameters
from prunus.session import status_of
from prunus.session.journal import Head, append, begin, read_journal, resume
from prunus.session.timeline import Timeline

HEAD = Head.model_validate(
    {
        "input": {"file": "tree.ply", "sha256": "00", "points": 3},
        "params": Parameters().model_dump(),
        "seed": 0,
        "frame": "auto",
        "unit": None,
        "base": None,
        "superpoints": "ab",
        "gives": "cd",
        "version_of_prunus": "0",
    }
)
MOVES = [RemoveEdge(3), "undo", "redo", RemoveEdge(4), SetStatus(True)]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """A journal with all kinds of lines."""
    path = tmp_path / JOURNAL
    end = begin(path, HEAD)
    for move in MOVES:
        _, end = append(path, end, move, "ff")
    return path


def line(path: Path, number: int, text: str) -> bytes:
    """Replace a line; the new contents."""
    lines = path.read_text().splitlines()
    lines[number - 1] = text
    path.write_text("\n".join(lines) + "\n")
    return path.read_bytes()


def test_what_was_written_is_read(path: Path) -> None:
    journal = read_journal(path)
    assert journal is not None
    assert journal.head == HEAD
    assert [one.move for one in journal.lines] == MOVES
    assert [one.number for one in journal.lines] == [2, 3, 4, 5, 6]


def test_at_first_there_is_nothing_to_undo_or_redo() -> None:
    assert not Timeline().can("undo")
    assert not Timeline().can("redo")
    assert Timeline().can(RemoveEdge(1))


def test_undone_acts_do_not_stand(path: Path) -> None:
    journal = read_journal(path)
    assert journal is not None
    timeline = Timeline.of(journal.lines)
    assert timeline.standing == [RemoveEdge(3), RemoveEdge(4), SetStatus(True)]


@pytest.mark.parametrize("cut", range(1, 60))
def test_a_torn_last_line_is_dropped_and_written_over(path: Path, cut: int) -> None:
    whole = path.read_bytes()
    path.write_bytes(whole[:-cut])
    journal = read_journal(path)
    assert journal is not None
    lost = 0 if cut == 1 else 1
    assert len(journal.lines) == len(MOVES) - lost
    _, end = append(path, resume(path, journal), RemoveEdge(9), "ff")
    again = read_journal(path)
    assert again is not None
    assert [one.move for one in again.lines] == [*MOVES[: len(MOVES) - lost], RemoveEdge(9)]
    assert end.size == len(path.read_bytes())


@pytest.mark.parametrize(
    ("number", "text", "says"),
    [
        (1, "{}", ":1: head.input: missing"),
        (1, '{"format": "other"}', ":1: head"),
        (1, json.dumps(HEAD.model_dump() | {"seed": "x"}), ":1: head.seed"),
        (1, json.dumps(HEAD.model_dump() | {"frame": "up"}), ":1: unknown frame 'up'"),
        (1, json.dumps(HEAD.model_dump() | {"params": {"x": 1}}), ":1: x: unknown parameter"),
        (2, "what", ":2: not JSON"),
        (2, "[" * 100_000, ":2: not JSON"),
        (2, "[1]", ":2: list; expected an object"),
        (2, '{"at": 3, "act": "undo"}', ":2: at: found 3"),
        (2, '{"at": "2026-01-01", "act": "undo"}', ":2: nothing to undo"),
        (3, '{"at": "2026-01-01", "act": "redo"}', ":3: nothing to redo"),
        (3, '{"at": "2026-01-01", "act": "undo", "node": 1}', ":3: unknown act 'undo'"),
        (2, '{"at": "2026-01-01", "act": "fly"}', ":2: unknown act 'fly'"),
        (2, '{"at": "2026-01-01", "act": "remove_edge", "node": NaN}', ":2: not JSON"),
        (2, '{"at": "2026-01-01", "act": "remove_edge", "node": 1e400}', ":2: remove_edge.node"),
        (2, '{"at": "2026-01-01", "act": "remove_edge", "node": 1, "gives": 2}', ":2: gives"),
        (4, "", ":4: not JSON"),
    ],
)
def test_what_is_wrong_is_told_by_file_and_line(
    path: Path, number: int, text: str, says: str
) -> None:
    before = line(path, number, text)
    with pytest.raises(PrunusError) as raised:
        read_journal(path)
    assert str(raised.value).startswith(f"{path}{says}")
    assert path.read_bytes() == before


def test_binary_dirt_is_told_too(path: Path) -> None:
    path.write_bytes(b"\x00\xff\n" + path.read_bytes())
    with pytest.raises(PrunusError, match=r":1: holds zero bytes"):
        read_journal(path)


def test_no_journal_and_an_empty_one_are_none(tmp_path: Path) -> None:
    assert read_journal(tmp_path / JOURNAL) is None
    (tmp_path / JOURNAL).touch()
    assert read_journal(tmp_path / JOURNAL) is None


def test_what_another_process_wrote_is_not_written_over(path: Path) -> None:
    journal = read_journal(path)
    assert journal is not None
    end = resume(path, journal)
    append(path, end, RemoveEdge(1), "ff")
    before = path.read_bytes()
    with pytest.raises(PrunusError, match="another process wrote to it"):
        append(path, end, RemoveEdge(2), "ff")
    assert path.read_bytes() == before


def test_the_status_is_told_by_the_acts_that_stand(tmp_path: Path) -> None:
    path = tmp_path / JOURNAL
    assert status_of(tmp_path) == "new"
    end = begin(path, HEAD)
    assert status_of(tmp_path) == "new"
    for move, status in [
        (RemoveEdge(3), "in work"),
        ("undo", "new"),
        ("redo", "in work"),
        (SetStatus(True), "done"),
        (SetStatus(False), "in work"),
        ("undo", "done"),
    ]:
        _, end = append(path, end, move, "ff")
        assert status_of(tmp_path) == status


def test_labels_alone_are_work_too(tmp_path: Path) -> None:
    (tmp_path / "labels.jsonl").write_text('{"format": "prunus-edge-labels"}\n')
    assert status_of(tmp_path) == "new"
    with (tmp_path / "labels.jsonl").open("a") as file:
        file.write('{"edge": [1, 2]}\n')
    assert status_of(tmp_path) == "in work"
