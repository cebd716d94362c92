"""Reading and writing files without tracebacks and without half a file."""

from __future__ import annotations

import contextlib
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


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
