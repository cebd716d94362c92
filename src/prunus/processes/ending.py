"""How a program ends when a signal asks it to: in order, its files and processes cleared away."""

from __future__ import annotations

import os
import signal
import sys
import threading
from types import FrameType
from typing import Any, NoReturn

AGAIN_S = 0.05
"""So soon a signal comes again that came where nothing can be ended."""


class EndedBySignal(SystemExit):
    """Unwinds the program; its code is the exit status."""


def end_on_signals() -> None:
    """Ctrl-C, SIGTERM and the end of the terminal unwind this program: status 128 + the signal.

    A signal that is ignored, as by nohup or in the background of a script, stays so.
    """
    for name in ("SIGINT", "SIGTERM", "SIGHUP"):
        number = getattr(signal, name, None)
        usual = (signal.SIG_DFL, signal.default_int_handler)
        if number is not None and signal.getsignal(number) in usual:
            signal.signal(number, _end)
    sys.unraisablehook = _come_again


def _end(number: int, frame: FrameType | None) -> NoReturn:
    raise EndedBySignal(128 + number)


def _come_again(lost: Any) -> None:
    """Python drops what is raised in a callback from C, as from the compiler, and in a finalizer.

    Were it our signal, nothing would ever end.
    """
    if not isinstance(lost.exc_value, EndedBySignal):
        sys.__unraisablehook__(lost)
        return
    number = int(lost.exc_value.code or 0) - 128
    again = threading.Timer(AGAIN_S, os.kill, (os.getpid(), number))
    again.daemon = True
    again.start()
