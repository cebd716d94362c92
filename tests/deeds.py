"""What workers of the tests do; quick to import."""

from __future__ import annotations

import os
import signal
import sys
import time
from pathlib import Path

from prunus.errors import PrunusError


class StubbornError(Exception):
    """Goes on no journey."""

    def __init__(self, one: int, other: int) -> None:
        super().__init__(f"{one} and {other}")


def deed(what: str) -> str:
    """Do something good or bad."""
    match what:
        case "exit":
            os._exit(7)
        case "leave":
            sys.exit(3)
        case "kill":
            os.kill(os.getpid(), signal.SIGKILL)
        case "crash":
            os.kill(os.getpid(), signal.SIGSEGV)
        case "memory":
            raise MemoryError
        case "error":
            raise PrunusError("bad file")
        case "stubborn":
            raise StubbornError(1, 2)
    return what.upper()


def wait_for_ever(mark: Path) -> None:
    """Say that one is there, and leave a mark when told to end."""
    mark.touch()
    try:
        while True:
            time.sleep(0.05)
    finally:
        mark.unlink()


def sit_deaf(mark: Path) -> None:
    """Hear no signal."""
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    mark.touch()
    while True:
        time.sleep(0.05)
