"""Compiling is said when it happens, and remembered for where it happened."""

import logging
import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from prunus.geometry import compiled
from prunus.geometry.compiled import is_compiled, mark_compiled
from prunus.geometry.compiling import AGAIN_S, FIRST, Listener

CALL = (
    "import numpy as np; from prunus.paper.kernels.angles import turn_angle\n"
    "turn_angle(np.eye(3)[0], np.eye(3)[1]); print('ok')"
)


def of(module: str) -> Any:
    """An event of numba about a function of a module."""
    function = SimpleNamespace(__module__=module)
    return SimpleNamespace(data={"dispatcher": SimpleNamespace(py_func=function)})


class Heard:
    """A listener, and what it says when so many seconds are spent on kernels and between them."""

    def __init__(self, caplog: pytest.LogCaptureFixture) -> None:
        self.now, self.caplog = 50.0, caplog
        self.listener = Listener(lambda: self.now)

    def compiles(self, seconds: float, module: str = "prunus.fusion.axes") -> list[str]:
        self.caplog.clear()
        self.listener.on_start(of(module))
        self.now += seconds
        self.listener.on_end(of(module))
        return [record.getMessage() for record in self.caplog.records]


@pytest.fixture
def heard(caplog: pytest.LogCaptureFixture) -> Heard:
    return Heard(caplog)


def test_the_first_kernel_is_announced_and_then_it_is_quiet_for_a_while(heard: Heard) -> None:
    assert heard.compiles(1) == [FIRST]
    assert [heard.compiles(3) for _ in range(6)] == [[]] * 6
    heard.now += 5
    assert heard.compiles(3) == ["still compiling kernels (24 s)"]


def test_another_mode_hours_later_is_another_beginning(heard: Heard) -> None:
    heard.compiles(1)
    heard.now += 7200
    assert heard.compiles(1) == [FIRST]
    assert 0 < AGAIN_S < 30


def test_kernels_of_others_are_their_own_affair(heard: Heard) -> None:
    assert heard.compiles(60, module="mine") == []
    assert heard.compiles(1) == [FIRST]


@pytest.mark.parametrize(
    ("name", "level"), [("SpawnProcess-1", "WARNING"), ("SpawnProcess-2", "DEBUG")]
)
def test_of_many_workers_one_speaks(
    name: str, level: str, heard: Heard, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("prunus.geometry.compiling.parent_process", object)
    monkeypatch.setattr(
        "prunus.geometry.compiling.current_process", lambda: SimpleNamespace(name=name)
    )
    heard.caplog.set_level(logging.DEBUG)
    heard.compiles(1)
    assert [record.levelname for record in heard.caplog.records] == [level]


def run(cache: Path) -> subprocess.CompletedProcess[str]:
    env = os.environ | {"PRUNUS_CACHE_DIR": str(cache)}
    return subprocess.run([sys.executable, "-c", CALL], env=env, capture_output=True, text=True)


@pytest.mark.slow
def test_a_python_program_reads_it_without_asking_and_once_a_machine(tmp_path: Path) -> None:
    first, second = run(tmp_path), run(tmp_path)
    assert first.stdout == second.stdout == "ok\n", first.stderr
    assert first.stderr == FIRST + "\n"
    assert second.stderr == ""


@pytest.mark.parametrize("other", ["mode", "installation", "machine"])
def test_what_was_compiled_counts_for_its_mode_installation_and_machine(
    other: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(compiled, "cache_dir", lambda: tmp_path)
    assert not is_compiled("axes ours")
    mark_compiled("axes ours")
    assert is_compiled("axes ours")
    if other == "mode":
        assert not is_compiled("random paper")
        return
    if other == "installation":
        twin = tmp_path / "twin" / "geometry"
        twin.mkdir(parents=True)
        for source in Path(compiled.__file__).parent.glob("*.py"):
            (twin / source.name).write_bytes(source.read_bytes())
        monkeypatch.setattr(compiled, "__file__", str(twin / "compiled.py"))
    else:
        monkeypatch.setattr("prunus.geometry.compiled.platform.node", lambda: "another")
    assert not is_compiled("axes ours")
