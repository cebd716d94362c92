"""Processes that tests start, and that end with them."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

GRACE_S = 20.0
"""How long a process may take to end when it is asked to."""


@contextmanager
def child(*words: str) -> Iterator[subprocess.Popen[str]]:
    """Python with these words, its pipes open; it ends with the block, whatever it ignores."""
    command = [sys.executable, *words]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True) as process:
        try:
            yield process
        finally:
            end(process)


def end(process: subprocess.Popen[str]) -> None:
    """Ask by SIGTERM, which no shell makes its children ignore as it does SIGINT; then kill."""
    process.terminate()
    try:
        process.wait(GRACE_S)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
