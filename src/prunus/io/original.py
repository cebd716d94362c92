"""The scan that something was made from, found again by its name and its sha256."""

from __future__ import annotations

import re
from collections.abc import Iterator
from glob import escape
from pathlib import Path

from prunus.errors import PrunusError
from prunus.files.safely import digest_of
from prunus.io.inputs import source_of
from prunus.io.skeletons.skeleton_file import InputRecord
from prunus.names import as_text


def original_of(record: InputRecord, folder: Path, scans: Path | None = None) -> Path:
    """The input that a file in the work folder NAME was made from.

    Looked for in `scans` where that is given, else in the folder, in those above it, and in the
    folder that one works in; there also one folder deeper, and in folders called NAME.
    Raises PrunusError where there is none of that name, or another content in all of that name, or
    the name is none.
    """
    file = record.file.partition("#")[0]
    if Path(file).name != file:
        raise PrunusError(f"input.file: found {record.file!r}; expected the name of a file")
    others = []
    for path in dict.fromkeys(_places(record.file, folder, scans)):
        if digest_of(source_of(path).path) == record.sha256:
            return path
        others.append(path)
    if others:
        raise PrunusError(
            f"{others[0]}: not the file that {folder} was made from (its sha256 is another); "
            "expected the same scan, unchanged: say where it is with --scans"
        )
    where = scans or f"{folder}, above it and in {Path.cwd()}"
    raise PrunusError(
        f"{record.file}: not found in {where}; expected the scan that {folder} was made from: "
        "say where it is with --scans"
    )


def _places(name: str, folder: Path, scans: Path | None) -> Iterator[Path]:
    """Where an input of that name lies, if anywhere; a topic of a bag keeps its topic."""
    file, _, topic = name.partition("#")
    own = folder.resolve()
    roots = [scans] if scans else [own, *list(own.parents)[:2], Path.cwd()]
    for root in roots:
        for pattern in ("", "*/", f"{escape(own.name)}/", f"*/{escape(own.name)}/"):
            for path in called(file, root, pattern):
                yield Path(f"{path}#{topic}") if topic else path


def called(name: str, folder: Path, below: str = "") -> list[Path]:
    """The files whose name is written down so, in a folder or in those of a pattern below it.

    A name that is no UTF-8 is written down with `%C4` for each such byte, see `names.as_text`.
    """
    exact = sorted(folder.glob(below + escape(name)))
    if exact or not _WRITTEN_BYTE.search(name):
        return exact
    like = folder.glob(below + _WRITTEN_BYTE.sub("?", escape(name)))
    return sorted(path for path in like if as_text(path.name) == name)


_WRITTEN_BYTE = re.compile("%[0-9A-F]{2}")
