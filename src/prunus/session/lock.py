"""Who has a tree open: a file beside the journal, so that two people do not correct one tree."""

from __future__ import annotations

import atexit
import contextlib
import getpass
import json
import os
import socket
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from filelock import FileLock

from prunus.errors import PrunusError
from prunus.files.safely import remove, write_bytes

NAME = "lock.json"
GUARD = ".lock.guard"
"""Stays in the folder: whoever removes it would part those who wait for it."""
PATIENCE = 5.0
"""Nobody keeps the guard so long, seconds."""
MINE: set[Path] = set()
"""The folders whose locks this process has."""


@dataclass(frozen=True, kw_only=True)
class Holder:
    """A process that has a tree open. `born`: when it started, where the system tells."""

    pid: int
    host: str
    user: str
    since: str
    born: str | None = None

    @classmethod
    def me(cls) -> Holder:
        """The process that asks."""
        now = datetime.now(UTC).isoformat(timespec="seconds")
        return cls(
            pid=os.getpid(),
            host=socket.gethostname(),
            user=_user(),
            since=now,
            born=_born(os.getpid()),
        )

    @property
    def told(self) -> str:
        """Who it is, in words."""
        return f"{self.user} on {self.host} since {self.since} (process {self.pid})"

    @property
    def is_gone(self) -> bool:
        """Whether the process is known to have ended; of another host nothing is known."""
        if self.host != socket.gethostname() or os.name == "nt":
            return False
        if self.born is not None and _born(self.pid) not in (None, self.born):
            return True
        try:
            os.kill(self.pid, 0)
        except ProcessLookupError:
            return True
        except (OSError, OverflowError):
            return False
        return False


def acquire(folder: Path) -> Holder | None:
    """Take the lock of a folder; None, or who holds it. A lock of an ended process is taken over.

    PrunusError where the folder cannot be written.
    """
    path = folder / NAME
    with _alone(folder):
        holder = _holder(_read(path))
        if holder is not None and not holder.is_gone:
            return holder
        write_bytes(path, (json.dumps(asdict(Holder.me())) + "\n").encode())
        MINE.add(folder)
    return None


def release(folder: Path) -> None:
    """Give the lock back, where this process has it."""
    path = folder / NAME
    with contextlib.suppress(PrunusError), _alone(folder):
        holder = _holder(_read(path))
        if holder is not None and (holder.pid, holder.host) == (os.getpid(), socket.gethostname()):
            remove(path)
        MINE.discard(folder)


@atexit.register
def _release_all() -> None:
    """A signal may end the process while a tree is being opened in another thread."""
    for folder in [folder for folder in MINE if (folder / NAME).exists()]:
        release(folder)


@contextlib.contextmanager
def _alone(folder: Path) -> Iterator[None]:
    """Keep all others from the lock while it is looked at and changed: milliseconds."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with FileLock(folder / GUARD, timeout=PATIENCE):
            yield
    except OSError as error:
        raise PrunusError(f"{folder}: cannot be locked ({error.strerror or error})") from error


def _read(path: Path) -> bytes:
    """What a lock holds; nothing where there is none."""
    try:
        return path.read_bytes()
    except FileNotFoundError:
        return b""
    except OSError as error:
        raise PrunusError(f"{path}: cannot be read ({error.strerror})") from error


def _holder(held: bytes) -> Holder | None:
    """Who a lock names; None where it names nobody."""
    try:
        values: dict[str, Any] = json.loads(held)
        return Holder(
            pid=int(values["pid"]),
            host=str(values["host"]),
            user=str(values["user"]),
            since=str(values["since"]),
            born=values.get("born"),
        )
    except (ValueError, TypeError, KeyError, AttributeError, OverflowError):
        return None


def _user() -> str:
    try:
        return getpass.getuser()
    except (OSError, KeyError, ImportError):
        return "someone"


def _born(pid: int) -> str | None:
    """When a process started, in ticks since the machine did; None where there is no /proc."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[19]
    except (OSError, IndexError, ValueError):
        return None
