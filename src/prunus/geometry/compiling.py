"""Says when kernels are compiled: the first run of all looks at nothing for a minute otherwise.

Numba tells of each function that it compiles and not of those that it loads from the disk, so this
is true whatever was compiled before, by which environment, and with which parameters.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Callable
from multiprocessing import current_process, parent_process
from typing import Any

from numba.core import event

LOG = logging.getLogger(__name__)
FIRST = "compiling kernels for this machine, once; for a first run that takes about a minute"
AGAIN_S = 20.0
"""While kernels are compiled it is said again when the next one begins after so long."""


class Listener(event.Listener):
    """Logs a warning when compiling begins, and now and then while it goes on."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self.clock = clock
        self.began = self.told = self.ended = float("-inf")

    def on_start(self, event: Any) -> None:
        """A function begins to be compiled."""
        now = self.clock()
        if not _is_ours(event) or now - self.told < AGAIN_S:
            return
        if now - self.ended > AGAIN_S:
            self.began = now
            text = FIRST
        else:
            text = f"still compiling kernels ({now - self.began:.0f} s)"
        self.told = now
        LOG.log(logging.WARNING if _speaks() else logging.DEBUG, text)

    def on_end(self, event: Any) -> None:
        """A function is compiled."""
        if _is_ours(event):
            self.ended = self.clock()


def listen() -> None:
    """From now on say when kernels are compiled."""
    event.register("numba:compile", Listener())  # type: ignore[no-untyped-call]


def _is_ours(event: Any) -> bool:
    """Whether it is a kernel of prunus, and none of who uses prunus."""
    return str(event.data["dispatcher"].py_func.__module__).startswith("prunus.")


def _speaks() -> bool:
    """Of several workers only the first one speaks: all of them compile the same."""
    return parent_process() is None or current_process().name.endswith("-1")
