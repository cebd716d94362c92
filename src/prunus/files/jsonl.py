"""Text files that only grow: one line of JSON after another, each safe on the disk once written.

A machine that dies in the middle of a line leaves a torn one: without its end, and no whole object.
It was never confirmed to anybody, so it is left out on reading and cut off before the next line is
written. A whole object that lacks its end, as an editor may leave it, counts.
"""

from __future__ import annotations

import contextlib
import errno
import json
import os
from io import FileIO
from pathlib import Path
from typing import Any

from prunus.errors import PrunusError
from prunus.files.reading import json_of, read_bytes, text_of
from prunus.files.safely import write_bytes

Line = dict[str, Any]


def whole_lines(content: bytes) -> list[bytes]:
    """The lines that were written whole, without blank ones at the end."""
    *lines, rest = content.split(b"\n")
    if _is_object(rest):
        lines.append(rest)
    while lines and not lines[-1].strip():
        lines.pop()
    return lines


def object_in(line: bytes, where: str) -> Line:
    """The object of a line; PrunusError beginning with `where` where it is none."""
    held = json_of(text_of(line, where), where)
    if not isinstance(held, dict):
        raise PrunusError(f"{where}: {type(held).__name__}; expected an object")
    return held


def read_lines_of(path: Path) -> list[tuple[int, Line]]:
    """The objects of a file, each with the number of its line from 1.

    PrunusError naming file and line where one is no JSON object.
    """
    return [
        (number, object_in(line, f"{path}: line {number}"))
        for number, line in enumerate(whole_lines(read_bytes(path)), 1)
        if line.strip()
    ]


def ended(path: Path) -> int:
    """The size in bytes of a file whose last line is ended now, what was torn cut off.

    PrunusError where it cannot be read or written.
    """
    content = read_bytes(path)
    kept = b"".join(line + b"\n" for line in whole_lines(content))
    if content != kept:
        write_bytes(path, kept)
    return len(kept)


def append_at(path: Path, size: int, line: Line) -> int:
    """Write a line at the end of a file of that size, wait until it is on the disk; the new size.

    PrunusError where it cannot be written, or another process wrote meanwhile: the file then stays
    as it was.
    """
    text = (json.dumps(line) + "\n").encode()
    try:
        with path.open("r+b", buffering=0) as file:
            _add(file, path, size, text)
    except OSError as error:
        raise PrunusError(f"{path}: cannot be written ({error.strerror})") from error
    return size + len(text)


def append_line(path: Path, line: Line, first: Line) -> None:
    """Write a line at the end, and `first` before it where the file has none; both on the disk.

    PrunusError where the file cannot be written.
    """
    size = ended(path) if path.exists() else 0
    if size == 0:
        text = (json.dumps(first) + "\n").encode()
        write_bytes(path, text)
        size = len(text)
    append_at(path, size, line)


def _add(file: FileIO, path: Path, size: int, text: bytes) -> None:
    if os.fstat(file.fileno()).st_size != size:
        raise PrunusError(f"{path}: another process wrote to it; open the tree again")
    try:
        file.seek(size)
        if file.write(text) != len(text):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        os.fsync(file.fileno())
    except OSError:
        with contextlib.suppress(OSError):
            file.truncate(size)
        raise


def _is_object(text: bytes) -> bool:
    try:
        return isinstance(json.loads(text), dict)
    except (ValueError, RecursionError):
        return False
