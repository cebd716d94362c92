"""Where compiled code is kept, and that nothing which goes wrong there stops a run."""

import errno
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType
from typing import Any, NoReturn

import numba
import pytest

from prunus.geometry import compiled

posix = pytest.mark.skipif(os.name != "posix", reason="homes and modes of POSIX")


def is_there(place: Path | None, root: Path) -> bool:
    return place is not None and place.is_dir() and place.is_relative_to(root)


@pytest.fixture
def world(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A home and a temporary folder of one's own, and nothing else."""
    for name in ("PRUNUS_CACHE_DIR", "XDG_CACHE_HOME", "NUMBA_CACHE_DIR"):
        monkeypatch.delenv(name, raising=False)
    for name in ("home", "tmp"):
        (tmp_path / name).mkdir()
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "tmp"))
    monkeypatch.setattr("sys.platform", "linux")
    (tmp_path / "file").touch()
    return tmp_path


@posix
@pytest.mark.parametrize(
    ("set_to", "expected"),
    [
        ({}, "home/.cache/prunus"),
        ({"XDG_CACHE_HOME": "{world}/xdg"}, "xdg/prunus"),
        ({"PRUNUS_CACHE_DIR": "{world}/own", "XDG_CACHE_HOME": "{world}/xdg"}, "own"),
        ({"NUMBA_CACHE_DIR": "{world}/numba"}, "home/.cache/prunus"),
        ({"XDG_CACHE_HOME": "{world}/file"}, "tmp"),
        ({"HOME": "{world}/file"}, "tmp"),
        ({"PRUNUS_CACHE_DIR": "{world}/file/x"}, "home/.cache/prunus"),
        ({"PRUNUS_CACHE_DIR": ""}, "home/.cache/prunus"),
    ],
)
def test_compiled_code_lies_in_the_first_place_that_can_be_written(
    set_to: dict[str, str], expected: str, world: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name, value in set_to.items():
        monkeypatch.setenv(name, value.format(world=world))
    assert is_there(compiled.cache_dir.__wrapped__(), world / expected)


@posix
def test_a_relative_cache_of_the_desktop_is_no_folder_of_where_one_works(
    world: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", "somewhere")
    monkeypatch.chdir(world)
    assert compiled.cache_dir.__wrapped__() is not None
    assert not (world / "somewhere").exists() and not (world / "~").exists()


@posix
@pytest.mark.parametrize("home", [None, "relative"])
def test_without_an_account_it_lies_in_the_temporary_folder(
    home: str | None, world: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def nobody(number: int) -> NoReturn:
        raise KeyError(f"getpwuid(): uid not found: {number}")

    monkeypatch.setattr("pwd.getpwuid", nobody)
    monkeypatch.chdir(world)
    if home is None:
        monkeypatch.delenv("HOME")
    else:
        monkeypatch.setenv("HOME", home)
    assert is_there(compiled.cache_dir.__wrapped__(), world / "tmp")
    assert not (world / "~").exists() and not (world / "relative").exists()


def nobodys(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder that somebody else made."""
    monkeypatch.setattr("os.geteuid", lambda: os.getuid() + 1)


def everybodys(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder.chmod(0o777)


def of_the_group(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder.chmod(0o775)


@posix
@pytest.mark.parametrize("make", [nobodys, everybodys, of_the_group])
@pytest.mark.parametrize("inner", [False, True])
def test_code_that_somebody_else_may_have_put_there_is_not_run(
    make: Callable[[Path, pytest.MonkeyPatch], None], inner: bool,
    world: Path, monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    monkeypatch.setenv("HOME", str(world / "file"))
    folder = compiled.cache_dir.__wrapped__()
    assert is_there(folder, world / "tmp")
    make(folder if inner else folder.parent, monkeypatch)
    assert compiled.cache_dir.__wrapped__() is None


@posix
def test_what_we_make_is_closed_to_others(world: Path) -> None:
    before = os.umask(0)
    try:
        folder = compiled.cache_dir.__wrapped__()
    finally:
        os.umask(before)
    assert [path.stat().st_mode & 0o777 for path in (folder, folder.parent)] == [0o700, 0o700]


def test_a_chosen_folder_that_is_not_used_is_named(
    world: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setenv("PRUNUS_CACHE_DIR", str(world / "file" / "x"))
    compiled.cache_dir.__wrapped__()
    assert str(world / "file" / "x") in caplog.text


@pytest.fixture
def module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[ModuleType]:
    """A module with a function to compile, and a cache of its own."""
    cache = tmp_path / "cache"
    cache.mkdir()
    monkeypatch.setattr(compiled, "cache_dir", lambda: cache)
    (tmp_path / "kernels_of_a_test.py").write_text("def twice(x):\n    return 2 * x\n")
    monkeypatch.syspath_prepend(tmp_path)
    import kernels_of_a_test  # type: ignore[import-not-found]

    yield kernels_of_a_test
    del sys.modules["kernels_of_a_test"]


def kept(tmp_path: Path) -> list[Path]:
    return [path for path in (tmp_path / "cache").rglob("*") if path.is_file()]


def test_a_kernel_is_compiled_once(module: Any, tmp_path: Path) -> None:
    assert compiled.kernel(module.twice)(4) == 8
    assert len(kept(tmp_path)) == 2
    again: Any = compiled.kernel(module.twice)
    assert again(4) == 8 and sum(again.stats.cache_hits.values()) == 1


@pytest.mark.parametrize("ending", [".nbi", ".nbc"])
@pytest.mark.parametrize("left", [0, 1, 40, -20])
def test_a_half_written_cache_is_compiled_anew(
    ending: str, left: int, module: Any, tmp_path: Path
) -> None:
    assert compiled.kernel(module.twice)(4) == 8
    whole = {path.name for path in kept(tmp_path)}
    path = next(path for path in kept(tmp_path) if path.suffix == ending)
    path.write_bytes(path.read_bytes()[:left])
    assert compiled.kernel(module.twice)(4) == 8
    assert {path.name for path in kept(tmp_path)} == whole
    again: Any = compiled.kernel(module.twice)
    assert again(4) == 8 and sum(again.stats.cache_hits.values()) == 1


def test_a_full_disk_costs_time_and_no_run(
    module: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> NoReturn:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(numba.core.caching.IndexDataCacheFile, "_save_data", full)
    assert compiled.kernel(module.twice)(4) == 8
    monkeypatch.undo()
    assert [path for path in kept(tmp_path) if path.suffix != ".nbi"] == []


def test_without_any_place_kernels_are_compiled_each_time(
    module: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(compiled, "cache_dir", lambda: None)
    made: Any = compiled.kernel(module.twice)
    assert made(4) == 8 and not made.stats.cache_path
    compiled.mark_compiled("mode")
    assert not compiled.is_compiled("mode")


def test_python_alone_runs_kernels_too() -> None:
    code = "from prunus.geometry.compiled import kernel; print(kernel(lambda x: 2 * x)(4))"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True,
        env=os.environ | {"NUMBA_DISABLE_JIT": "1"},
    )  # fmt: skip
    assert done.stdout == "8\n"
