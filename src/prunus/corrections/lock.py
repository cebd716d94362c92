"""Who has a tree open: a file beside the journal, so that two people do not correct one tree."""

from __future__ import annotations

import contextlib
import errno
import getpass
import json
import os
import socket
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from prunus.errors import PrunusError

NAME = "lock.json"


@dataclass(frozen=True)
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
        return cls(os.getpid(), socket.gethostname(), _user(), now, _born(os.getpid()))

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
    for _ in range(TRIES):
        if _created(path):
            return None
        held = _read(path)
        if held is None:
            continue
        holder = _holder(held)
        if holder is not None and not holder.is_gone:
            return holder
        _clear(path, held)
    raise PrunusError(f"{path}: others open and close this tree all the time; try again")


TRIES = 20
"""Whoever finds the lock changing hands tries again so often."""


def release(folder: Path) -> None:
    """Give the lock back, where this process has it."""
    path = folder / NAME
    holder = _holder(_read(path) or b"")
    if holder is not None and (holder.pid, holder.host) == (os.getpid(), socket.gethostname()):
        with contextlib.suppress(OSError):
            path.unlink()


def _created(path: Path) -> bool:
    """Write the lock in one go, if there is none: a half-written one is never seen."""
    temporary = path.with_name(f".{NAME}.{os.getpid()}.{os.urandom(4).hex()}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        text = json.dumps(asdict(Holder.me())) + "\n"
        temporary.write_text(text, encoding="utf-8")
        _link(temporary, path, text)
    except FileExistsError:
        return False
    except OSError as error:
        raise PrunusError(f"{path}: cannot be written ({error.strerror})") from error
    finally:
        with contextlib.suppress(OSError):
            temporary.unlink()
    return True


def _link(temporary: Path, path: Path, text: str) -> None:
    """Give a file a second name that must be free, or write it where a disk knows no such names."""
    try:
        os.link(temporary, path)
    except FileExistsError:
        raise
    except OSError as error:
        if error.errno not in (errno.EPERM, errno.ENOTSUP, errno.ENOSYS):
            raise
        with path.open("x", encoding="utf-8") as file:
            file.write(text)


def _clear(path: Path, stale: bytes) -> None:
    """Take a stale lock away; one that came in its place meanwhile is put back."""
    aside = path.with_name(f".{NAME}.{os.urandom(4).hex()}")
    with contextlib.suppress(OSError):
        path.rename(aside)
        if _read(aside) != stale:
            os.link(aside, path)
    with contextlib.suppress(OSError):
        aside.unlink()


def _read(path: Path) -> bytes | None:
    try:
        return path.read_bytes()
    except FileNotFoundError:
        return None
    except OSError as error:
        raise PrunusError(f"{path}: cannot be read ({error.strerror})") from error


def _holder(held: bytes) -> Holder | None:
    """Who a lock names; None where it names nobody."""
    try:
        values: dict[str, Any] = json.loads(held)
        return Holder(
            int(values["pid"]),
            str(values["host"]),
            str(values["user"]),
            str(values["since"]),
            values.get("born"),
        )
    except (ValueError, TypeError, KeyError, AttributeError):
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
