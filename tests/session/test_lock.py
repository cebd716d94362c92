"""One tree, one person: a lock of a live process holds, that of an ended one does not."""

import json
import os
import socket
import subprocess
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from prunus.session.lock import GUARD, NAME, Holder, acquire, release
from tests.processes.children import child


@pytest.fixture
def other() -> Iterator[subprocess.Popen[str]]:
    """Another process, alive."""
    with child("-c", "input()") as process:
        yield process


def write(folder: Path, **changed: object) -> bytes:
    """A lock of another; its contents."""
    holder = {
        "pid": os.getpid(),
        "host": socket.gethostname(),
        "user": "anna",
        "since": "2026-01-01T12:00:00+00:00",
        "born": None,
    }
    (folder / NAME).write_text(json.dumps(holder | changed))
    return (folder / NAME).read_bytes()


def test_the_second_is_told_who_was_first(tmp_path: Path) -> None:
    assert acquire(tmp_path / "tree") is None
    holder = acquire(tmp_path / "tree")
    assert holder is not None
    assert holder.pid == os.getpid()
    assert str(holder.pid) in holder.told
    release(tmp_path / "tree")
    assert acquire(tmp_path / "tree") is None


def test_a_live_process_keeps_its_lock(tmp_path: Path, other: subprocess.Popen[str]) -> None:
    held = write(tmp_path, pid=other.pid)
    holder = acquire(tmp_path)
    assert holder is not None
    assert "anna on " in holder.told
    release(tmp_path)
    assert (tmp_path / NAME).read_bytes() == held, "what is another's is not given back"


def test_the_lock_of_an_ended_process_is_taken_over(tmp_path: Path) -> None:
    with child("-c", "") as ended:
        ended.wait()
    write(tmp_path, pid=ended.pid)
    assert acquire(tmp_path) is None
    assert json.loads((tmp_path / NAME).read_text())["pid"] == os.getpid()


def test_a_process_with_the_number_of_an_ended_one_is_another(tmp_path: Path) -> None:
    if Holder.me().born is None:
        pytest.skip("the system does not tell when a process began")
    write(tmp_path, born="1")
    assert acquire(tmp_path) is None


def test_of_another_machine_nothing_is_known(tmp_path: Path) -> None:
    write(tmp_path, host="elsewhere", pid=1)
    holder = acquire(tmp_path)
    assert holder is not None
    assert "elsewhere" in holder.told


@pytest.mark.parametrize("text", ["", "{", "[]", '{"pid": "x"}', "\x00"])
def test_a_lock_that_names_nobody_is_taken_over(tmp_path: Path, text: str) -> None:
    (tmp_path / NAME).write_text(text)
    assert acquire(tmp_path) is None


def test_of_many_at_once_one_gets_it(tmp_path: Path) -> None:
    for stale in range(20):
        write(tmp_path, born=str(stale))
        with ThreadPoolExecutor(8) as pool:
            came = list(pool.map(lambda _: acquire(tmp_path), range(16)))
        assert sum(holder is None for holder in came) == 1
    assert {path.name for path in tmp_path.iterdir()} == {NAME, GUARD}


def test_a_lock_is_given_back_when_the_process_ends_however_far_it_was(tmp_path: Path) -> None:
    code = (
        "import sys\nfrom pathlib import Path\nfrom prunus.session.lock import acquire, NAME\n"
        "assert acquire(Path(sys.argv[1])) is None and (Path(sys.argv[1]) / NAME).exists()\n"
        "sys.exit(143)"
    )
    with child("-c", code, tmp_path) as process:
        assert process.wait(60) == 143
    assert not (tmp_path / NAME).exists()
