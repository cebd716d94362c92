"""What `--help` says, that options mean the same everywhere, and what a slip of the finger gets."""

import inspect
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
import typer.main
from typer.testing import CliRunner

from prunus.cli import app
from prunus.cuts import CutRules, shipped_rules
from prunus.params import Parameters
from tests.test_cli import prunus

ROOT = Path(__file__).resolve().parents[1]
COMMANDS = typer.main.get_command(app).commands  # type: ignore[attr-defined]
NAMES = list(COMMANDS)
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
SHARED = [
    "--base", "--frame", "--unit", "--points", "--params", "--weights", "--no-isolate", "--scans",
    "--jobs",
]  # fmt: skip


def help_of(name: str) -> str:
    narrow = {"COLUMNS": "80", "TERMINAL_WIDTH": "80", "NO_COLOR": "1"}
    return CliRunner().invoke(app, [name, "--help"], env=narrow).stdout


def options_of(name: str) -> dict[str, str]:
    """The options of a command, in each of their spellings, with what is said of them."""
    return {
        spelling: str(one.help)
        for one in COMMANDS[name].params
        for spelling in one.opts
        if spelling.startswith("-")
    }


@pytest.mark.parametrize("name", NAMES)
def test_help_fits_a_terminal_and_has_an_example(name: str) -> None:
    text = help_of(name)
    assert max(map(len, text.splitlines())) <= 80
    assert f"prunus {name}" in text.replace(f"Usage: prunus {name}", ""), "no example"
    for line in inspect.getdoc(COMMANDS[name].callback).split("\n\n")[1:]:
        example = line.split(": `prunus")
        if len(example) == 2 and len(line) <= 78:
            assert f"prunus{example[1].rstrip('`')}" in text, "an example is broken in two"


@pytest.mark.parametrize("option", SHARED)
def test_an_option_says_the_same_in_every_command(option: str) -> None:
    said = {options_of(name)[option] for name in NAMES if option in options_of(name)}
    assert len(said) == 1


def test_a_cloud_is_read_and_skeletonized_with_the_same_options_by_cuts() -> None:
    chain = {"--base", "--at", "--frame", "--unit", "--points", "--params", "--seed", "--weights",
             "--no-isolate"}  # fmt: skip
    for name in ("skeletonize", "cuts"):
        assert chain <= set(options_of(name))
    ways = {"--frame", "--unit", "--points", "--params", "--seed"}
    assert ways | {"--base", "--at"} <= set(options_of("isolate"))
    assert ways | {"--no-isolate", "--scans"} <= set(options_of("studio"))


@pytest.mark.parametrize(
    ("words", "meant"),
    [
        (["skeletonise"], "skeletonize"), (["cut"], "cuts"), (["evalute"], "evaluate"),
        (["skeletonize", "a.ply", "--bsae", "1"], "--base"),
        (["cuts", "a.ply", "--rule"], "--rules"),
        (["isolate", "a.ply", "--lits"], "--list"), (["convert", "a", "b", "--untis"], "--unit"),
    ],
)  # fmt: skip
def test_a_slip_is_answered_with_what_was_meant(words: list[str], meant: str) -> None:
    done = prunus(*words)
    assert done.exit_code == 2
    assert re.search(rf"{meant}\b", done.stderr.split("No such")[1])


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_the_documentation_uses_commands_and_options_that_exist(page: Path) -> None:
    text = page.read_text().replace("\\\n", " ")
    for name, rest in re.findall(r"\bprunus ([a-z]+)((?: (?:[^\s`#|>]+))*)", text):
        if name not in COMMANDS:
            continue
        for option in re.findall(r"(?<= )--?[a-z][a-z-]*", rest):
            assert option in {*options_of(name), "--help", "-h"}, f"prunus {name} {option}"


def test_what_is_shipped_is_printed_as_it_is_read(tmp_path: Path) -> None:
    for words, read, held in (
        (["rules"], CutRules.from_toml, shipped_rules()),
        (["params"], Parameters.from_toml, Parameters()),
        (["params", "default"], Parameters.from_toml, Parameters()),
        (["params", "paper"], Parameters.from_toml, Parameters.paper()),
    ):
        (tmp_path / "printed.toml").write_text(prunus(*words).stdout)
        assert read(tmp_path / "printed.toml") == held


@pytest.mark.parametrize(
    ("typed", "offered"),
    [("prunus sk", "skeletonize"), ("prunus cuts a.ply --no", "--no-isolate")],
)
def test_the_shell_completes(typed: str, offered: str) -> None:
    asked = {"_PRUNUS_COMPLETE": "complete_bash", "COMP_WORDS": typed,
             "COMP_CWORD": str(len(typed.split()) - 1)}  # fmt: skip
    code = "import sys; sys.argv = ['prunus']; from prunus.cli import main; main()"
    done = subprocess.run(
        [sys.executable, "-c", code], env=os.environ | asked, capture_output=True, text=True
    )
    assert offered in done.stdout.split()
