"""The exceptions that the library raises on purpose, and the exit statuses of the command line."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from enum import IntEnum
from pathlib import Path


class PrunusError(ValueError):
    """Bad input: the message names the file or field, what was found and what was expected."""


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
    INTERRUPTED = 130, "stopped by Ctrl-C (SIGINT)"
    TERMINATED = 143, "stopped by SIGTERM"

    @classmethod
    def of(cls, error: PrunusError) -> Status:
        """The status with which an error ends a command."""
        return cls.WRONG_COMMAND if isinstance(error, OptionError) else cls.FAILED
