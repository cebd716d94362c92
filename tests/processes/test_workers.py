"""Work side by side, whatever becomes of the workers."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import NoReturn

import pytest

from prunus.errors import PrunusError
from prunus.processes.workers import WorkerError, in_order, side_by_side
from tests.deeds import deed, sit_deaf, wait_for_ever
from tests.processes.children import child, session, until

needs_proc = pytest.mark.skipif(not Path("/proc").is_dir(), reason="looks into /proc")


BAD = {
    "exit": (WorkerError, "exit status 7"),
    "leave": (WorkerError, "exit status 3"),
    "kill": (WorkerError, "killed, perhaps for want of memory"),
    "crash": (WorkerError, "signal 11"),
    "memory": (MemoryError, ""),
    "error": (PrunusError, "bad file"),
    "stubborn": (RuntimeError, "StubbornError: 1 and 2"),
}


@pytest.mark.parametrize("jobs", [1, 2, 8])
def test_every_item_comes_once_and_only_the_guilty_fail(jobs: int) -> None:
    items = ["a", "kill", "b", *BAD, "c", "exit", "d"]
    found = {done.number: done for done in side_by_side(deed, items, jobs)}
    assert sorted(found) == list(range(len(items)))
    for number, item in enumerate(items):
        done = found[number]
        if item in BAD:
            kind, text = BAD[item]
            assert type(done.error) is kind and text in str(done.error)
        else:
            assert (done.made, done.error) == (item.upper(), None)


@pytest.mark.parametrize("jobs", [1, 3])
def test_results_come_in_order(jobs: int) -> None:
    assert list(in_order(deed, [*"abcdefg"], jobs)) == [*"ABCDEFG"]
    assert list(in_order(deed, [], jobs)) == []


@pytest.mark.parametrize(("what", "kind"), [("error", PrunusError), ("crash", WorkerError)])
def test_in_order_the_first_failure_is_raised(what: str, kind: type[Exception]) -> None:
    with pytest.raises(kind):
        list(in_order(deed, ["a", what, "b"], 2))


def test_an_item_for_which_no_process_starts_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    def none(process: object) -> NoReturn:
        raise BlockingIOError(11, "Resource temporarily unavailable")

    monkeypatch.setattr("multiprocessing.context.SpawnProcess.start", none)
    found = list(side_by_side(deed, ["a", "b"], 2))
    assert sorted(done.number for done in found) == [0, 1]
    assert all("no process could be started" in str(done.error) for done in found)


PARENT = """
import sys
from collections.abc import Callable
from pathlib import Path
from prunus.processes.ending import end_on_signals
from prunus.processes.workers import side_by_side
from tests import deeds

if __name__ == "__main__":
    end_on_signals()
    marks = [Path(word) for word in sys.argv[2:]]
    list(side_by_side(getattr(deeds, sys.argv[1]), marks, len(marks)))
"""


@needs_proc
@pytest.mark.parametrize(
    ("work", "number"),
    [
        (wait_for_ever, signal.SIGTERM),
        (wait_for_ever, signal.SIGINT),
        (wait_for_ever, signal.SIGHUP),
        (wait_for_ever, signal.SIGKILL),
        (sit_deaf, signal.SIGTERM),
        (sit_deaf, signal.SIGKILL),
    ],
)
@pytest.mark.slow
def test_no_worker_outlives_its_parent(
    work: Callable[[Path], None], number: signal.Signals, tmp_path: Path
) -> None:
    (tmp_path / "parent.py").write_text(PARENT)
    marks = [tmp_path / "one", tmp_path / "two"]
    words = [tmp_path / "parent.py", work.__name__, *marks]
    env = os.environ | {"PYTHONPATH": os.pathsep.join([*sys.path, str(Path.cwd())])}
    with child(*words, env=env, stderr=subprocess.PIPE) as parent:
        until(lambda: all(mark.exists() for mark in marks), "two busy workers")
        assert len(session(parent.pid)) >= 3
        parent.send_signal(number)
        status = parent.wait(60)
        assert status == (-number if number == signal.SIGKILL else 128 + number)
        until(lambda: not session(parent.pid), "the end of all processes")
        assert parent.stderr.read() == ""
    if work is wait_for_ever:
        assert not any(mark.exists() for mark in marks), "they cleared away before they ended"


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_a_signal_that_was_ignored_stays_ignored_and_sigterm_still_ends() -> None:
    code = (
        "import signal, time\nfrom prunus.processes.ending import end_on_signals\n"
        "end_on_signals()\n"
        "print(signal.getsignal(signal.SIGINT) == signal.SIG_IGN, flush=True)\ntime.sleep(60)"
    )
    words = ["import os, signal, sys; signal.signal(signal.SIGINT, signal.SIG_IGN); "
             "os.execv(sys.executable, [sys.executable, '-c', sys.argv[1]])", code]  # fmt: skip
    with child("-c", *words) as process:
        assert process.stdout.readline() == "True\n"
        process.send_signal(signal.SIGINT)
        process.terminate()
        assert process.wait(60) == 128 + signal.SIGTERM


LOST = {
    "in a callback from C": "ctypes.CFUNCTYPE(None)(hit)()",
    "in a finalizer": "type('Thing', (), {'__del__': lambda self: hit()})()",
}


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
@pytest.mark.parametrize("where", LOST)
def test_a_signal_ends_the_program_wherever_it_strikes(where: str) -> None:
    code = (
        "import ctypes, os, signal, time\nfrom prunus.processes.ending import end_on_signals\n"
        "end_on_signals()\n"
        "def hit():\n    os.kill(os.getpid(), signal.SIGTERM)\n    time.sleep(1)\n"
        f"{LOST[where]}\ntime.sleep(60)"
    )
    with child("-c", code, stderr=subprocess.PIPE) as process:
        assert process.communicate(timeout=30) == ("", "")
        assert process.returncode == 128 + signal.SIGTERM
