"""Reading and writing files without tracebacks and without half a file."""

from __future__ import annotations

import contextlib
import hashlib
import os
import tempfile
from pathlib import Path

from prunus.errors import PrunusError


def read_bytes(path: Path) -> bytes:
    """The whole file; PrunusError where it is missing, a folder, unreadable or empty."""
    try:
        content = path.read_bytes()
    except OSError as error:
        raise PrunusError(f"{path}: cannot be read ({error.strerror})") from error
    if not content:
        raise PrunusError(f"{path}: the file is empty")
    return content


def check_readable(path: Path) -> None:
    """Raise the PrunusError of `read_bytes` without reading a large file; folders pass."""
    if path.is_dir():
        return
    try:
        with path.open("rb") as file:
            first = file.read(1)
    except OSError as error:
        raise PrunusError(f"{path}: cannot be read ({error.strerror})") from error
    if not first:
        raise PrunusError(f"{path}: the file is empty")


def digest_of(path: Path) -> str:
    """The sha256 of a file, or of the files right inside a folder, one after another by name."""
    files = sorted(p for p in path.iterdir() if p.is_file()) if path.is_dir() else [path]
    whole = hashlib.sha256()
    try:
        for one in files:
            with one.open("rb") as file:
                while block := file.read(2**20):
                    whole.update(block)
    except OSError as error:
        raise PrunusError(f"{path}: cannot be read ({error.strerror})") from error
    return whole.hexdigest()


def write_bytes(path: Path, content: bytes) -> None:
    """Write to a temporary name beside the file, then rename: never half a file.

    Raises PrunusError on a folder that cannot be made or written, and on a full disk; an older
    file of that name then stays as it was.
    """
    temporary = None
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        Path(temporary).chmod(0o666 & ~_umask())
        Path(temporary).replace(path)
    except OSError as error:
        if temporary is not None:
            with contextlib.suppress(OSError):
                Path(temporary).unlink()
        raise PrunusError(f"{path}: cannot be written ({error.strerror})") from error


def remove(path: Path) -> None:
    """Remove a file, if it is there; PrunusError where that cannot be done."""
    try:
        path.unlink(missing_ok=True)
    except OSError as error:
        raise PrunusError(f"{path}: cannot be removed ({error.strerror})") from error


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
