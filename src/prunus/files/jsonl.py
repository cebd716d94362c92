"""Text files that only grow: one line of JSON after another, each safe on the disk once written.

A machine that dies in the middle of a line leaves a torn one, without its end. It was never
confirmed to anybody, so it is dropped on reading and cut off before the next line is written.
"""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

from prunus.errors import PrunusError
from prunus.files.reading import json_of, read_bytes, text_of

Line = dict[str, Any]


def read_lines_of(path: Path) -> list[tuple[int, Line]]:
    """The whole lines of a file, each with its number from 1; a torn last one is left out.

    PrunusError naming file and line where one is no JSON object.
    """
    return [
        (number, _object(line, path, number))
        for number, line in enumerate(read_bytes(path).split(b"\n")[:-1], 1)
        if line.strip()
    ]


def append_line(path: Path, line: Line, first: Line) -> None:
    """Write a line at the end, and `first` before it where the file has none; both on the disk.

    PrunusError where the file cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.open("r+b" if path.exists() else "w+b") as file:
            whole = _cut_torn(file.read())
            file.truncate(whole)
            file.seek(whole)
            new = [line] if whole else [first, line]
            file.write("".join(json.dumps(one) + "\n" for one in new).encode())
            file.flush()
            os.fsync(file.fileno())
    except OSError as error:
        raise PrunusError(f"{path}: cannot be written ({error.strerror})") from error


def _cut_torn(content: bytes) -> int:
    """How many bytes the whole lines take."""
    return content.rfind(b"\n") + 1


def _object(line: bytes, path: Path, number: int) -> Line:
    where = f"{path}: line {number}"
    held = json_of(text_of(line, where), where)
    if not isinstance(held, dict):
        raise PrunusError(f"{where}: {type(held).__name__}; expected an object")
    return held
