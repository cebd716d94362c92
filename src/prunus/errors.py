"""The exceptions raised on purpose, what is said of all others, and the exit statuses."""

from __future__ import annotations

import os
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from enum import IntEnum
from pathlib import Path

from prunus.names import in_line


class PrunusError(ValueError):
    """Bad input: the message names the file or field, what was found and what was expected.

    The message is one line of valid UTF-8, whatever names are in it.
    """

    def __init__(self, text: object = "") -> None:
        super().__init__(in_line(text))


class NoTreeError(PrunusError):
    """Nothing that can be a tree was found: the message says why, and what to try."""


class OptionError(PrunusError):
    """Not an input but the command is wrong: an option, or the file that an option names."""


@contextmanager
def blaming_the_command() -> Iterator[None]:
    """What is wrong in here is the fault of an option, not of an input."""
    try:
        yield
    except PrunusError as error:
        raise OptionError(str(error)) from error


@contextmanager
def naming(path: Path) -> Iterator[None]:
    """What is wrong in here names the file."""
    try:
        yield
    except PrunusError as error:
        if str(path) in str(error):
            raise
        raise type(error)(f"{path}: {error}") from error


class Status(IntEnum):
    """What the exit status of a command says; each member has its meaning in words."""

    about: str

    def __new__(cls, value: int, about: str) -> Status:
        """A member with its meaning."""
        member = int.__new__(cls, value)
        member._value_ = value
        member.about = about
        return member

    DONE = 0, "all that was asked for is done"
    FAILED = 1, "an input failed, nothing was found in it, or an output cannot be written"
    WRONG_COMMAND = 2, "the command was wrong: an option, or a file that an option names"
    HUNG_UP = 129, "stopped because its terminal was closed (SIGHUP)"
    INTERRUPTED = 130, "stopped by Ctrl-C (SIGINT)"
    TERMINATED = 143, "stopped by SIGTERM"

    @classmethod
    def of(cls, error: PrunusError) -> Status:
        """The status with which an error ends a command."""
        return cls.WRONG_COMMAND if isinstance(error, OptionError) else cls.FAILED


def describe(error: BaseException) -> str:
    """An exception in one line. One that we did not foresee is a fault of ours, and said to be one.

    With PRUNUS_DEBUG in the environment its traceback goes to standard error.
    """
    if isinstance(error, PrunusError):
        return str(error)
    if os.environ.get("PRUNUS_DEBUG"):
        traceback.print_exception(error)
    if isinstance(error, MemoryError):
        return "not enough memory"
    if isinstance(error, OSError) and error.strerror:
        return in_line(f"{error.filename}: {error.strerror}" if error.filename else error.strerror)
    return in_line(
        f"internal error, please report it: {type(error).__name__}: {error} "
        "(PRUNUS_DEBUG=1 shows where)"
    )
