"""Nobody looks at nothing for long: what is said, when, and where."""

import io
import json
import logging
import os
import shutil
import subprocess
import sys
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

import pytest
from rich.console import Console

from prunus.commands.progress import AGAIN_S, SOON_S, Step, Teller, Waiting
from prunus.io.clouds.cloud_file import write_cloud
from prunus.lab.simulate.orchard import write_simulated
from tests.conftest import field_scan
from tests.processes.children import Child, child
from tests.test_statuses import COMMANDS


class Clock:
    """Stands still until it is told to go on."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


class Said:
    """A waiting whose clock is set by hand, and the lines that it said."""

    def __init__(self, terminal: bool = False) -> None:
        self.text, self.clock = io.StringIO(), Clock()
        console = Console(file=self.text, force_terminal=terminal, width=200, emoji=False)
        self.waiting = Waiting(console, self.clock)

    def after(self, seconds: float) -> list[str]:
        """What is said in so many seconds, looked for every quarter of one."""
        start = len(self.text.getvalue())
        for _ in range(round(4 * seconds)):
            self.clock.now += 0.25
            self.waiting.tick()
        return self.text.getvalue()[start:].splitlines()


def test_what_is_quick_is_not_talked_about() -> None:
    said = Said()
    for what in ("reading", "thinking", "writing"):
        said.waiting.doing(what)
        assert said.after(SOON_S - 0.5) == []


def test_a_long_step_is_named_soon_and_then_every_half_minute() -> None:
    said = Said()
    said.waiting.doing("reading tree.ply")
    assert said.after(2) == ["reading tree.ply"]
    assert said.after(AGAIN_S - 2) == []
    assert said.after(2) == ["still reading tree.ply (32 s)"]
    assert said.after(2 * AGAIN_S) == [f"still reading tree.ply ({n} s)" for n in (62, 92)]


def test_what_is_known_to_take_long_is_named_at_once_and_once() -> None:
    said = Said()
    said.waiting.doing("loading torch", at_once=True)
    assert said.text.getvalue() == "loading torch\n"
    assert said.after(10) == []


def test_counted_things_say_how_far_they_are() -> None:
    said = Said()
    things = said.waiting.watch(range(5), "trees", 5)
    assert [next(things), next(things)] == [0, 1]
    assert said.after(2) == ["trees: 2 of 5"]
    assert list(things) == [2, 3, 4]
    assert said.after(AGAIN_S) == ["trees: 5 of 5 (32 s)"]


@pytest.mark.parametrize("word", ["say", "tell"])
def test_any_word_counts(word: str, capsys: pytest.CaptureFixture[str]) -> None:
    said = Said()
    said.waiting.doing("trees", 9)
    said.after(AGAIN_S - 5)
    line = f"tree.ply: done by {word}"
    said.waiting.say(line) if word == "say" else said.waiting.tell([line])
    assert line in said.text.getvalue() + capsys.readouterr().out
    assert said.after(AGAIN_S - 1) == [], "the last was said so lately"
    assert len(said.after(1)) == 1


def test_nothing_is_said_while_nothing_is_waited_for() -> None:
    said = Said()
    said.waiting.doing("opening the studio")
    said.waiting.rest()
    assert said.after(1000) == []


def test_a_terminal_gets_a_bar_and_no_reminders() -> None:
    said = Said(terminal=True)
    said.waiting.doing("reading tree.ply")
    said.after(1)
    assert said.text.getvalue() == ""
    said.after(AGAIN_S)
    said.waiting.rest()
    assert "reading tree.ply" in said.text.getvalue() and "still" not in said.text.getvalue()


def test_what_the_library_warns_of_is_said_and_what_it_notes_is_not() -> None:
    said = Said()
    with said.waiting:
        logging.getLogger("prunus.geometry.compiling").warning("compiling")
        logging.getLogger("prunus.io").info("a note")
    logging.getLogger("prunus").debug("afterwards")
    assert "compiling\n" in said.text.getvalue()
    assert "note" not in said.text.getvalue()
    assert said.waiting.ears not in logging.getLogger("prunus").handlers


def test_a_name_that_is_no_utf8_is_printed_as_it_is_written(
    capsys: pytest.CaptureFixture[str],
) -> None:
    Said().waiting.tell([os.fsdecode(b"tree\xff.ply: done")])
    assert capsys.readouterr().out == "tree%FF.ply: done\n"


def test_failures_among_many_are_told_again_at_the_end() -> None:
    said = Said()
    teller = Teller(said.waiting, as_json=True)
    for name in ("a.ply", "b.ply"):
        teller.tell({"ok": False, "error": f"{name}: empty"})
    teller.sum_up()
    assert said.text.getvalue().splitlines()[2:] == [
        "2 of 2 failed:", "  a.ply: empty", "  b.ply: empty",
    ]  # fmt: skip


def test_a_step_counts_in_words() -> None:
    assert Step(what="trees", total=3, began=0.0, done=2).named() == "trees: 2 of 3"
    assert Step(what="fusing", total=None, began=10.0).reminder(70.4) == "still fusing (60 s)"


def started(words: list[str], **how: Any) -> AbstractContextManager[Child]:
    code = "import sys; from prunus.cli import main; sys.argv[0] = 'prunus'; main()"
    return child("-c", code, *words, text=False, **how)


@pytest.mark.skipif(sys.platform == "win32", reason="no terminals to play")
def test_json_goes_to_the_file_while_the_bar_goes_to_the_terminal(tmp_path: Path) -> None:
    import pty

    (tmp_path / "bad.xyz").write_text("1 2\n")
    master, terminal = pty.openpty()
    words = ["skeletonize", str(tmp_path / "bad.xyz"), "--json"]
    with started(words, stdout=subprocess.PIPE, stderr=terminal) as run:
        os.close(terminal)
        assert run.stdout is not None
        assert json.loads(run.stdout.read())["ok"] is False
    os.close(master)


def test_standard_output_is_json_alone_whatever_is_said_beside_it(tmp_path: Path) -> None:
    (tmp_path / "bad.xyz").write_text("1 2\n")
    words = ["skeletonize", str(tmp_path / "bad.xyz"), "--json"]
    with started(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as run:
        out, err = run.communicate()
    assert [json.loads(line)["ok"] for line in out.splitlines()] == [False]
    assert b"rows hold 2 numbers" in err


LONG = [
    "skeletonize scan.ply -o out --params paper", "fuse rig/tree_000003 -o raw.ply", "demo -o demo",
    "simulate -n 1 -o orchard", "experiment -o results --trees 1 --draws 1",
    "train rig -o w.onnx --jobs 1",
]  # fmt: skip


@pytest.fixture(scope="module")
def scanned_row(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a scan, and with five trees as `prunus simulate` writes them."""
    home = tmp_path_factory.mktemp("row")
    cloud = field_scan(3).target_cloud()
    write_cloud(home / "scan.ply", cloud.to_input.apply(cloud.xyz))
    write_simulated(home / "rig" / "tree_000003", field_scan(3), views=True)
    for number in range(4, 8):
        shutil.copytree(home / "rig" / "tree_000003", home / "rig" / f"tree_{number:06d}")
    return home


@pytest.mark.slow
@pytest.mark.parametrize("command", LONG)
def test_the_first_word_of_a_first_run_comes_before_its_work(
    command: str, scanned_row: Path, tmp_path: Path
) -> None:
    """Nothing is compiled yet: the process is ended once it said so."""
    fresh = os.environ | {"PRUNUS_CACHE_DIR": str(tmp_path / "cache")}
    with started(command.split(), cwd=scanned_row, env=fresh, stdout=subprocess.PIPE,
                 stderr=subprocess.PIPE) as run:  # fmt: skip
        assert run.stderr is not None
        said = b""
        while b"compiling kernels" not in said:
            line = run.stderr.readline()
            assert line, f"it ended without a word: {said.decode()}"
            said += line
        assert run.poll() is None, "it is said before, not after"
        run.terminate()


def test_every_command_is_waited_for_by_the_same_one() -> None:
    """The bar and the reminders belong to the group, so that no command can be silent."""
    from prunus import cli

    for command in cli.app.registered_commands:
        assert command.callback is not None
        assert "ctx" in command.callback.__annotations__
    assert len(COMMANDS) == len(cli.app.registered_commands)
