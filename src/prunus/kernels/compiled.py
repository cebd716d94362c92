"""How kernels are compiled, and where the compiled code is kept.

Numba notices when the file of a kernel changes, but not when that of a kernel it calls does. So
the compiled code lies in a folder named after the text of all kernels.
"""

from __future__ import annotations

import hashlib
import os
import platform
import sys
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

import numba

from prunus.kernels.compiling import listen

listen()

Parameters = ParamSpec("Parameters")
Returned = TypeVar("Returned")


def kernel(function: Callable[Parameters, Returned]) -> Callable[Parameters, Returned]:
    """Compile at the first call, keep the machine code on disk, check no bounds."""
    config: Any = numba.config
    before = config.CACHE_DIR
    config.CACHE_DIR = str(cache_dir())
    try:
        return numba.njit(cache=True, nogil=True)(function)
    finally:
        config.CACHE_DIR = before


@cache
def cache_dir() -> Path:
    """The folder of the compiled code (`PRUNUS_CACHE_DIR` moves it); made when missing."""
    digest = hashlib.sha256(f"{numba.__version__} {sys.version_info[:2]}".encode())
    for source in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(source.read_bytes())
    for root in (_user_cache(), Path(tempfile.gettempdir()) / "prunus"):
        folder = root / f"kernels-{digest.hexdigest()[:16]}"
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError:
            continue
        if os.access(folder, os.W_OK):
            return folder
    return Path(tempfile.mkdtemp(prefix="prunus-"))


def is_compiled(mode: str) -> bool:
    """Whether a whole run in this mode has filled the cache: this installation, this machine."""
    return _mark(mode).exists()


def mark_compiled(mode: str) -> None:
    """Remember that a whole run in this mode has filled the cache."""
    _mark(mode).touch()


def _mark(mode: str) -> Path:
    """Named after what numba goes by: where a kernel lies, its time, and the machine."""
    whole = hashlib.sha256(f"{mode} {platform.node()}".encode())
    for source in sorted(Path(__file__).resolve().parent.glob("*.py")):
        whole.update(f"{source} {source.stat().st_mtime_ns}".encode())
    return cache_dir() / f"complete-{whole.hexdigest()[:16]}"


def _user_cache() -> Path:
    chosen = os.environ.get("PRUNUS_CACHE_DIR")
    if chosen:
        return Path(chosen)
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA", Path.home())) / "prunus"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "prunus"
    return Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "prunus"
