"""How kernels are compiled, and where the compiled code is kept.

Numba notices when the file of a kernel changes, but not when that of a kernel it calls does. So
the compiled code lies in a folder named after the text of all kernels.
"""

from __future__ import annotations

import hashlib
import logging
import os
import platform
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

import numba
from numba.core.caching import FunctionCache
from platformdirs import user_cache_path

from prunus.geometry.compiling import listen

listen()

Parameters = ParamSpec("Parameters")
Returned = TypeVar("Returned")

LOG = logging.getLogger(__name__)
Cache: Any = FunctionCache
"""Of numba, which says little of its types."""


class _Kept(Cache):  # type: ignore[misc]
    """The machine code of a kernel on the disk, where what goes wrong costs time and no more."""

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """What was kept; None where there is nothing that can be read: a half-written file too."""
        try:
            return super().load_overload(sig, target_context)
        except Exception:  # pickle fails in every way there is; then the kernel is compiled anew
            with suppress(OSError):
                self.flush()
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep it, unless the disk is full, or what was there cannot be read or replaced."""
        with suppress(Exception):
            super().save_overload(sig, data)


def kernel(function: Callable[Parameters, Returned]) -> Callable[Parameters, Returned]:
    """Compile at the first call, keep the machine code on disk, check no bounds."""
    folder = cache_dir()
    config: Any = numba.config
    made: Any = numba.njit(nogil=True)(function)
    if folder is None or config.DISABLE_JIT:
        return made
    before = config.CACHE_DIR
    config.CACHE_DIR = str(folder)
    try:
        made._cache = _Kept(function)
    finally:
        config.CACHE_DIR = before
    return made


@cache
def cache_dir() -> Path | None:
    """The folder of the compiled code, made when missing; None where there is no safe place.

    `PRUNUS_CACHE_DIR`, else the user's cache, else the temporary folder, whichever can be written
    and by nobody else: what lies there is run.
    """
    digest = hashlib.sha256(f"{numba.__version__} {sys.version_info[:2]}".encode())
    for source in _sources():
        digest.update(source.read_bytes())
    for root in _roots():
        folder = root / f"kernels-{digest.hexdigest()[:16]}"
        if _is_own(root) and _is_own(folder):
            return folder
        if str(root) == os.environ.get("PRUNUS_CACHE_DIR"):
            LOG.warning("PRUNUS_CACHE_DIR: %s is not a folder that you alone can write to", root)
    return None


def _sources() -> list[Path]:
    """The files of this package that hold kernels: one may hold the code of another."""
    home = Path(__file__).resolve().parents[1]
    return sorted(path for path in home.rglob("*.py") if b"\n@kernel" in path.read_bytes())


def _roots() -> Iterator[Path]:
    """Where compiled code may be kept, the best place first."""
    chosen = os.environ.get("PRUNUS_CACHE_DIR")
    if chosen:
        yield Path(chosen)
    with suppress(OSError, RuntimeError):  # an account without a home, or no account at all
        cache = user_cache_path("prunus", appauthor=False)
        if cache.is_absolute():
            yield cache
    with suppress(OSError):  # no temporary folder either
        user = os.getuid() if hasattr(os, "getuid") else "user"
        yield Path(tempfile.gettempdir()) / f"prunus-{user}"


def _is_own(folder: Path) -> bool:
    """Whether a folder is there, made if missing, that this user and nobody else can write to."""
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        held = folder.stat()
    except OSError:
        return False
    # On Windows the folders of a user are closed to others, and modes tell nothing.
    own = os.name == "nt" or (held.st_uid == os.geteuid() and not held.st_mode & 0o022)
    return own and os.access(folder, os.W_OK | os.X_OK)


def is_compiled(mode: str) -> bool:
    """Whether a whole run in this mode has filled the cache: this installation, this machine."""
    mark = _mark(mode)
    return mark is not None and mark.exists()


def mark_compiled(mode: str) -> None:
    """Remember that a whole run in this mode has filled the cache."""
    mark = _mark(mode)
    if mark is not None:
        with suppress(OSError):
            mark.touch()


def _mark(mode: str) -> Path | None:
    """Named after what numba goes by: where a kernel lies, its time, and the machine."""
    folder = cache_dir()
    whole = hashlib.sha256(f"{mode} {platform.node()}".encode())
    for source in _sources():
        whole.update(f"{source} {source.stat().st_mtime_ns}".encode())
    return folder and folder / f"complete-{whole.hexdigest()[:16]}"
