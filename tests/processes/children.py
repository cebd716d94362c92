"""Processes that tests start, and that end with them."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

GRACE_S = 20.0
"""How long a process may take to end when it is asked to."""
PATIENCE_S = 180.0
"""After so long nothing more is expected; a slow machine compiles the kernels meanwhile."""

Child = subprocess.Popen[str]


@contextmanager
def child(*words: object, **options: Any) -> Iterator[Child]:
    """Python with these words, its pipes open; it ends with the block, whatever it ignores.

    It heads a session of its own, so that what it started ends too.
    """
    command = [sys.executable, *map(str, words)]
    options = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True} | options
    with hearing_signals():
        started = subprocess.Popen(command, start_new_session=True, **options)
    with started as process:
        try:
            yield process
        finally:
            end(process)


@contextmanager
def hearing_signals() -> Iterator[None]:
    """Children that begin here hear SIGINT and SIGHUP, also where tests run in the background.

    Shells make what runs there ignore the one, nohup the other. A signal that is ignored would be
    so in children too; one that is handled is theirs to handle.
    """
    numbers = [signal.SIGINT, *([signal.SIGHUP] if os.name == "posix" else [])]
    before = {number: signal.getsignal(number) for number in numbers}
    for number in numbers:
        signal.signal(number, signal.default_int_handler)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def prunus(*words: object, **options: Any) -> contextlib.AbstractContextManager[Child]:
    """The command line in a process of its own, see `child`."""
    return child("-m", "prunus.cli", *words, stderr=subprocess.PIPE, **options)


def end(process: Child) -> None:
    """Ask by SIGTERM, which no shell makes its children ignore as it does SIGINT; then kill."""
    process.terminate()
    with contextlib.suppress(subprocess.TimeoutExpired):
        process.wait(GRACE_S)
    if os.name == "posix":
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
    process.kill()
    process.wait()


def session(leader: int) -> list[int]:
    """The processes of the session of a child that are there and no zombies; needs /proc."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            state, _, _, head = (folder / "stat").read_text().rpartition(")")[2].split()[:4]
            if int(head) == leader and state not in "ZX":
                found.append(int(folder.name))
    return found


def until(holds: Callable[[], Any], what: str) -> Any:
    """What a condition gives once it holds; fails where it does not come to."""
    end = time.monotonic() + PATIENCE_S
    while not (found := holds()):
        if time.monotonic() > end:
            pytest.fail(f"waited in vain: {what}")
        time.sleep(0.02)
    return found
