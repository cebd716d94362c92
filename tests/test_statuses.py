"""Exit statuses: the same cause has the same one, whatever the command.

1: an input (what a command is given without an option) fails. 2: an option, or a file that an
option names, is wrong.
"""

import json
from pathlib import Path

import numpy as np
import pytest

from prunus.errors import OptionError, PrunusError, Status, blaming_the_command
from prunus.io.clouds.cloud_file import write_cloud
from prunus.io.skeletons.skeleton_file import write_skeleton
from tests.drawn import tree
from tests.test_cli import prunus

COMMANDS = [
    "skeletonize", "isolate", "cuts", "convert", "fuse", "studio", "demo", "simulate", "train",
    "evaluate", "experiment", "rules", "params", "schema",
]  # fmt: skip
DONE, FAILED, WRONG = Status.DONE, Status.FAILED, Status.WRONG_COMMAND
NOWHERE = "/proc/nowhere"

MISSING_INPUT = [
    "skeletonize none.ply", "skeletonize none.mcap", "isolate none.ply --list",
    "isolate none.ply -o t.ply", "cuts none.ply", "cuts none.json", "cuts none.swc",
    "convert none.ply t.xyz", "convert none.json t.swc", "fuse none -o t.ply", "studio none.ply",
    "studio none", "train none -o w.onnx", "evaluate none.json s.json", "evaluate s.json none.ply",
]  # fmt: skip
BROKEN_INPUT = [
    "skeletonize bad.xyz", "isolate bad.xyz --list", "cuts bad.xyz", "convert bad.xyz t.ply",
    "cuts bad.json", "cuts bad.swc", "convert bad.json t.swc", "convert bad.swc t.ply",
    "evaluate bad.json s.json", "evaluate s.json bad.json", "fuse rig -o t.ply",
    "skeletonize empty", "studio empty", "train empty -o w.onnx", "evaluate empty empty",
    "fuse empty -o t.ply",
]  # fmt: skip
MISSING_FILE_OF_AN_OPTION = [
    "skeletonize cloud.xyz --params none.toml", "skeletonize cloud.xyz --weights none.onnx",
    "skeletonize none.ply --weights none.onnx", "cuts cloud.xyz --params none.toml",
    "cuts cloud.xyz --weights none.onnx", "cuts cloud.xyz --rules none.toml",
    "cuts s.json --rules none.toml", "cuts s.json --scans none",
    "convert s.json t.mcap --cloud none.ply", "convert s.json t.mcap --cuts none.json",
    "studio cloud.xyz --params none.toml", "train orchard -o w.onnx --from none.onnx",
    "train orchard -o w.onnx --scans none", "experiment -o e --gold none",
    "experiment -o e --gold empty --scans none",
]  # fmt: skip
BROKEN_FILE_OF_AN_OPTION = [
    "skeletonize cloud.xyz --params bad.toml", "skeletonize cloud.xyz --params bad.json",
    "skeletonize cloud.xyz --weights bad.json", "skeletonize cloud.xyz --params empty",
    "cuts cloud.xyz --params bad.toml", "cuts cloud.xyz --weights bad.json",
    "cuts cloud.xyz --rules bad.toml", "cuts s.json --rules bad.json",
    "cuts s.json --rules empty", "cuts s.json --scans bad.json",
    "convert s.json t.mcap --cloud bad.xyz", "convert s.json t.mcap --cuts bad.json",
    "studio cloud.xyz --params bad.toml", "train orchard -o w.onnx --from bad.json",
    "experiment -o e --gold empty", "experiment -o e --gold bad.json",
]  # fmt: skip
BAD_VALUE = [
    "simulate -o e --scan any --views",
    "skeletonize cloud.xyz --points few", "skeletonize cloud.xyz --points 0",
    "skeletonize cloud.xyz --frame up", "skeletonize cloud.xyz --unit furlong",
    "skeletonize cloud.xyz --seed -1", "skeletonize cloud.xyz --base 1 2",
    "skeletonize cloud.xyz --jobs 0", "isolate cloud.xyz --list --frame up", "isolate cloud.xyz",
    "isolate cloud.xyz --list --at 0 0 0", "cuts cloud.xyz --points few", "cuts cloud.xyz --unit x",
    "convert cloud.xyz t.ply --unit x", "studio cloud.xyz --port 99999", "params theirs",
    "studio cloud.xyz --host 999.1.1.1 --port 0 --no-open", "simulate -n 0 -o o", "demo --seed x",
    "train orchard -o w.onnx --epochs 0", "experiment -o e --trees 0", "schema nothing",
    "evaluate s.json",
]  # fmt: skip
OF_NO_USE = [
    "cuts s.json --base 0 0 0", "cuts s.json --at 0 0 0", "cuts s.json --seed 1",
    "cuts s.json --points 100", "cuts s.json --no-isolate", "cuts s.json --params paper",
    "convert s.json t.glb --cuts plan.json", "convert s.json t.glb --cloud cloud.xyz",
]  # fmt: skip
UNKNOWN_KIND_OF_OUTPUT = [
    "convert s.json t.doc", "convert cloud.xyz t.obj", "convert none.ply t.doc",
    "fuse empty -o t.stl", "isolate cloud.xyz -o t.doc", "isolate cloud.xyz -o t.xyz --classes",
]  # fmt: skip
UNWRITABLE_OUTPUT = [
    f"convert s.json {NOWHERE}/t.swc", f"convert cloud.xyz {NOWHERE}/t.ply",
    f"cuts s.json -o {NOWHERE}/plan.json", f"evaluate s.json s.json --csv {NOWHERE}/t.csv",
    f"simulate -n 1 --jobs 1 -o {NOWHERE}", f"demo -o {NOWHERE}",
]  # fmt: skip
RIGHT = [
    "convert s.json t.swc", "cuts s.json", "evaluate s.json s.json", "rules", "params",
    "params paper", "schema", "schema status", "skeletonize --help", "--version",
]  # fmt: skip

CASES = [
    *((command, FAILED) for command in [*MISSING_INPUT, *BROKEN_INPUT, *UNWRITABLE_OUTPUT]),
    *((f"{command} --nonsense", WRONG) for command in COMMANDS),
    *((command, WRONG) for command in [
        *MISSING_FILE_OF_AN_OPTION, *BROKEN_FILE_OF_AN_OPTION, *BAD_VALUE, *OF_NO_USE,
        *UNKNOWN_KIND_OF_OUTPUT,
    ]),
    *((command, DONE) for command in RIGHT),
]  # fmt: skip


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a good skeleton and cloud, and with what is wrong in several ways."""
    home = tmp_path_factory.mktemp("place")
    write_skeleton(home / "s.json", tree())
    write_cloud(home / "cloud.xyz", np.random.default_rng(0).uniform(0, 1, (100, 3)))
    for name, text in {
        "bad.xyz": "1 2\n", "bad.json": "[1, 2]", "bad.swc": "1 2 3\n", "bad.toml": "[search]\nk=1",
        "rig/rig.json": "{}", "orchard/tree/trees.npz": "",
    }.items():  # fmt: skip
        (home / name).parent.mkdir(parents=True, exist_ok=True)
        (home / name).write_text(text)
    for number in range(5):
        (home / f"orchard/tree_{number}").mkdir()
        (home / f"orchard/tree_{number}/trees.npz").touch()
    (home / "empty").mkdir()
    return home


@pytest.mark.parametrize(("command", "status"), CASES)
def test_the_same_cause_has_the_same_status(
    command: str, status: Status, place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if command.startswith("train"):
        pytest.importorskip("torch")
    monkeypatch.chdir(place)
    done = prunus(*command.split())
    assert done.exit_code == status, done.output
    if status != DONE:
        assert done.stderr.strip() and "Traceback" not in done.output
        assert done.stdout == ""


def test_the_table_knows_every_command() -> None:
    from prunus.cli import app

    assert {command.name or command.callback.__name__ for command in app.registered_commands} == (
        set(COMMANDS)
    )


def test_one_failure_among_many_is_told_in_each_line_and_by_the_status(place: Path) -> None:
    done = prunus("skeletonize", place / "bad.xyz", place / "none.ply", "--json")
    assert done.exit_code == FAILED
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    assert [line["ok"] for line in lines] == [False, False]


def test_who_is_to_blame_decides_on_the_status() -> None:
    with pytest.raises(OptionError, match="why"), blaming_the_command():
        raise PrunusError("why")
    assert Status.of(OptionError("")) == WRONG and Status.of(PrunusError("")) == FAILED
