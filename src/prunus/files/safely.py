"""Reading and writing files without tracebacks and without half a file."""

from __future__ import annotations

import contextlib
import hashlib
import os
import shutil
import tempfile
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import Any

from prunus.errors import PrunusError
from prunus.files.reading import check_kind
from prunus.files.reading import read_bytes as read_bytes
from prunus.names import in_line

TEMPORARY = ".prunus-"
"""How the names of unfinished files begin; they are short, so that any name of a file will do."""

BYTE_ORDER_MARK = b"\xef\xbb\xbf"
"""What Excel and Notepad put before UTF-8."""


@contextlib.contextmanager
def parsing(named: object, kind: str) -> Iterator[None]:
    """The one door to other people's parsers: whatever they raise becomes a PrunusError.

    `named` is what the file is called in the message, `kind` what it was taken for.
    """
    # Broad on purpose, and the only place that is: numpy, laspy, lazrs, pye57, rosbags, zipfile,
    # zlib and Pillow raise whatever their parsing trips over, each other's errors too, and lazrs,
    # which is Rust, panics with a BaseException. The file is at fault in every case.
    try:
        yield
    except (PrunusError, KeyboardInterrupt, SystemExit, GeneratorExit):
        raise
    except MemoryError as error:
        raise PrunusError(f"{named}: too large for the memory there is ({kind})") from error
    except BaseException as error:
        why = " ".join(str(error).split())[:200] or type(error).__name__
        raise PrunusError(f"{named}: not a readable {kind}: {why}") from error


@contextlib.contextmanager
def plainly_named(path: Path) -> Iterator[Path]:
    """The path, or a link to it where its name trips libraries up.

    SQLite takes some signs for marks of an address; a name that is no UTF-8 is no text elsewhere.
    """
    name = str(path)
    if not set("#?%") & set(name) and name.isprintable():
        yield path
        return
    with tempfile.TemporaryDirectory() as folder:
        link = Path(folder) / f"link{path.suffix}"
        link.symlink_to(path.absolute())
        yield link


def path_of(name: Any) -> Path:
    """The path that a caller named; PrunusError where it is none."""
    try:
        path = Path(os.fsdecode(name))
    except TypeError:
        raise PrunusError(f"path: {name!r:.80}; expected the name of a file") from None
    if "\0" in str(path):
        raise PrunusError(f"path: {name!r:.80}; expected no zero byte in a name")
    return path


def check_readable(path: Path) -> None:
    """Raise the PrunusError of `read_bytes` without reading a large file; folders pass."""
    if path.is_dir():
        return
    try:
        check_kind(path)
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

    Raises PrunusError on a folder that cannot be made or written, on a full disk, and where there
    is a pipe or a device; an older file of that name then stays as it was. A link stays a link.
    """
    temporary = None
    try:
        target = Path(os.path.realpath(path))
        if path.exists():
            check_kind(path)
        target.parent.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(dir=target.parent, prefix=TEMPORARY)
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        Path(temporary).chmod(0o666 & ~_umask())
        Path(temporary).replace(target)
    except OSError as error:
        raise PrunusError(f"{path}: cannot be written ({error.strerror})") from error
    finally:
        if temporary is not None:
            with contextlib.suppress(OSError):
                Path(temporary).unlink()


@contextlib.contextmanager
def written_together(folder: Path, last: str, older: Collection[str] = ()) -> Iterator[Path]:
    """A folder to write to, whose files then come into `folder` together, `last` after the others.

    So a file called `last` says that all beside it is whole and of one run, even where a run was
    killed: an older one goes before the first new file comes, and so do the files called as
    `older` says, which would else be taken for the new run's. Nothing comes of a run that fails.
    Raises PrunusError where the folder cannot be made or written.
    """
    temporary = None
    try:
        folder.mkdir(parents=True, exist_ok=True)
        temporary = Path(tempfile.mkdtemp(dir=folder, prefix=TEMPORARY))
        yield temporary
        for name in (last, *older):
            (folder / name).unlink(missing_ok=True)
        for path in sorted(temporary.iterdir(), key=lambda path: path.name == last):
            path.replace(folder / path.name)
    except OSError as error:
        raise PrunusError(f"{folder}: cannot be written ({error.strerror})") from error
    except PrunusError as error:
        raise PrunusError(str(error).replace(in_line(temporary), in_line(folder))) from error
    finally:
        if temporary is not None:
            shutil.rmtree(temporary, ignore_errors=True)


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
