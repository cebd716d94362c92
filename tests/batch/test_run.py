"""A batch that goes on whatever its files are and whatever becomes of its workers."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest

from prunus.io.clouds.cloud_file import write_cloud
from tests.conftest import simulated
from tests.processes.children import prunus, session, until

posix = pytest.mark.skipif(os.name != "posix", reason="names are bytes on POSIX alone")
needs_proc = pytest.mark.skipif(not Path("/proc").is_dir(), reason="looks into /proc")

POISON = """
import os, signal, sys, time

DEEDS = {
    "crash.ply": lambda: os.kill(os.getpid(), signal.SIGSEGV),
    "killed.ply": lambda: os.kill(os.getpid(), signal.SIGKILL),
    "exit.ply": lambda: os._exit(0),
    "leave.ply": lambda: sys.exit("a library leaves"),
    "memory.ply": lambda: bytearray(2**62),
    "fault.ply": lambda: 1 / 0,
}

STALLED = os.environ.get("STALLED", "")

def stall():
    with open(STALLED, "w"):
        pass
    while True:
        time.sleep(0.02)

def poison(event, args):
    if event == "open" and isinstance(args[0], str):
        name = os.path.basename(args[0])
        if name.startswith(os.environ.get("STALL", "/")) and not os.path.exists(STALLED):
            stall()
        DEEDS.get(name, bool)()

sys.addaudithook(poison)
"""
"""What a file does to the process that opens it; one that is called STALL holds it up."""

FAULTS = {
    "crash": "signal 11",
    "killed": "perhaps for want of memory",
    "exit": "exit status 0",
    "leave": "exit status",
    "memory": "memory",
    "fault": "internal error, please report it: ZeroDivisionError",
}


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small scan of which a skeleton comes in a second."""
    truth, cloud = simulated(2)
    path = tmp_path_factory.mktemp("tree") / "tree.ply"
    write_cloud(path, (cloud.to_input.apply(cloud.xyz) - truth.xyz[0])[::2])
    return path


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "in").mkdir()
    return tmp_path / "in"


@pytest.fixture
def poisoned(tmp_path: Path) -> dict[str, str]:
    """The environment in which files of some names are poisonous."""
    (tmp_path / "site").mkdir()
    (tmp_path / "site" / "sitecustomize.py").write_text(POISON)
    return os.environ | {"PYTHONPATH": os.pathsep.join([str(tmp_path / "site"), *sys.path])}


def batch(folder: Path, out: Path, *words: object, **options: Any) -> tuple[int, list[Any], str]:
    """Status, records and standard error of a batch."""
    with prunus(
        "skeletonize", folder, "-o", out, "--no-report", "--frame", "z-up", "--json", *words,
        **options,
    ) as process:  # fmt: skip
        said, errors = process.communicate(timeout=300)
        return process.returncode, [json.loads(line) for line in said.splitlines()], errors


@pytest.mark.parametrize(
    ("jobs", "faults"),
    [
        (2, ["crash", "fault"]),
        pytest.param(1, [*FAULTS], marks=pytest.mark.slow),
        pytest.param(8, [*FAULTS], marks=pytest.mark.slow),
    ],
)
def test_poisonous_files_cost_themselves_alone(
    jobs: int, faults: list[str], tree: Path, folder: Path, poisoned: dict[str, str], tmp_path: Path
) -> None:
    for name in ("a", *faults, "z"):
        os.link(tree, folder / f"{name}.ply")
    status, records, errors = batch(folder, tmp_path / "out", "--jobs", jobs, env=poisoned)
    assert status == 1 and "Traceback" not in errors
    assert sorted(Path(record["file"]).stem for record in records) == sorted(["a", "z", *faults])
    for record in records:
        stem = Path(record["file"]).stem
        assert record["ok"] == (stem in "az"), record
        if not record["ok"]:
            assert FAULTS[stem] in record["error"] and record["file"] in record["error"]
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["a", "z"]


@pytest.mark.slow
def test_a_fault_of_ours_is_told_in_a_line_and_its_traceback_shown_on_demand(
    tree: Path, poisoned: dict[str, str], tmp_path: Path
) -> None:
    path = tmp_path / "fault.ply"
    os.link(tree, path)
    status, (record,), errors = batch(path, tmp_path / "out", env=poisoned | {"PRUNUS_DEBUG": "1"})
    assert status == 1 and "ZeroDivisionError" in record["error"]
    assert "Traceback" in errors
    with prunus("cuts", path, env=poisoned) as process:
        _, errors = process.communicate(timeout=300)
    assert process.returncode == 1
    assert "prunus: internal error, please report it: ZeroDivisionError" in errors
    assert "Traceback" not in errors


NONE = {
    "link.ply": (lambda path: path.symlink_to("nowhere.ply"), "cannot be read"),
    "loop.ply": (lambda path: path.symlink_to("loop.ply"), "cannot be read"),
    "pipe.ply": (os.mkfifo, "a pipe or a device; expected a file"),
    "zero.xyz": (lambda path: path.symlink_to("/dev/zero"), "a pipe or a device; expected a file"),
    "empty.pcd": (Path.touch, "the file is empty"),
    "same.xyz": (lambda path: path.write_text("1 2 3\n"), ""),
    "same.csv": (lambda path: path.write_text("1,2,3\n"), "has the same name as"),
}
"""Files of which nothing can come: how each is made, and what is said of it."""


@posix
def test_files_that_are_none_are_told_and_never_waited_for(folder: Path, tmp_path: Path) -> None:
    for name, (make, _) in NONE.items():
        make(folder / name)
    paths = [folder / name for name in NONE]
    status, records, _ = batch(paths[0], tmp_path / "out", *paths[1:], "--jobs", 2)
    said = " ".join(record["error"] for record in records)
    assert status == 1 and not any(record["ok"] for record in records)
    assert sorted(Path(record["file"]).name for record in records) == sorted(NONE)
    for name, (_, text) in NONE.items():
        assert name in said and text in said
    assert not (tmp_path / "out").exists()


@posix
@pytest.mark.slow
def test_names_of_every_kind_are_done_and_written_as_utf8(
    tree: Path, folder: Path, tmp_path: Path
) -> None:
    names = {
        b"\xc4pfel.ply": "%C4pfel.ply",
        b"\xff\xfe.ply": "%FF%FE.ply",
        b"line\nbreak.ply": "line\nbreak.ply",
        b"\x1b[31mred.ply": "\x1b[31mred.ply",
        "\u6843 \u00fc.ply".encode(): "\u6843 \u00fc.ply",
        b"n" * 250 + b".ply": "n" * 250 + ".ply",
        b"\xe9" * 250 + b".ply": "%E9" * 250 + ".ply",
    }
    for name in names:
        os.link(tree, folder / os.fsdecode(name))
    status, records, errors = batch(folder, tmp_path / "out", "--jobs", 2, "--traits")
    assert status == 0, errors
    assert sorted(Path(record["file"]).name for record in records) == sorted(names.values())
    assert len(list((tmp_path / "out").iterdir())) == len(names)
    for record in records:
        skeleton = Path(record["skeleton"])
        assert json.loads(skeleton.read_text("utf-8"))["input"]["file"] in names.values()
        assert (skeleton.parent / "traits.csv").read_text("utf-8")


@posix
@pytest.mark.slow
def test_a_name_that_is_no_utf8_goes_through_every_command(tree: Path, tmp_path: Path) -> None:
    scan = tmp_path / os.fsdecode(b"\xc4pfel.ply")
    os.link(tree, scan)
    out = tmp_path / "out"
    for words in (
        ["skeletonize", scan, "-o", out, "--traits"],
        ["convert", out / "skeleton.json", scan.with_suffix(".swc")],
        ["convert", scan, scan.with_suffix(".xyz")],
        ["cuts", scan, "-o", scan.with_suffix(".json")],
        ["cuts", out / "skeleton.json", "-o", out / "plan.json", "--scans", tmp_path],
        ["evaluate", scan.with_suffix(".swc"), out / "skeleton.json"],
        ["isolate", scan, "--list"],
    ):
        with prunus(*words) as process:
            _, errors = process.communicate(timeout=300)
        assert process.returncode == 0, (words, errors)
    assert "%C4pfel.ply" in (out / "report.html").read_text("utf-8")
    assert json.loads((out / "plan.json").read_text("utf-8"))["input"]["file"] == "%C4pfel.ply"
    with prunus("skeletonize", scan.with_stem(f"{scan.stem}-none"), "-o", out) as process:
        _, errors = process.communicate(timeout=300)
    assert process.returncode == 1 and "%C4pfel-none.ply: cannot be read" in errors


LONG = {
    "a batch": ("tree.ply", "skeletonize {in} -o {out} --jobs 2", signal.SIGTERM),
    "a batch, Ctrl-C": ("tree.ply", "skeletonize {in} -o {out} --jobs 1", signal.SIGINT),
    "a tree, writing": (".prunus-", "skeletonize {in}/tree.ply -o {out} --no-report", 15),
    "isolate": ("tree.ply", "isolate {in}/tree.ply --list", signal.SIGINT),
    "cuts": ("tree.ply", "cuts {in}/tree.ply", signal.SIGHUP),
    "fuse": ("rig.json", "fuse {in} -o {out}/a.ply", signal.SIGTERM),
    "simulate": (".prunus-", "simulate -n 3 --jobs 2 -o {out}", signal.SIGTERM),
    "experiment": ("paper.onnx", "experiment --trees 2 --jobs 2 -o {out}", signal.SIGINT),
    "train": ("scan.ply", "train {in} --jobs 2 -o {out}/a.onnx", signal.SIGTERM),
}
"""Commands: the file at which each is held up, its words, and the signal that it then gets."""
QUICK = ("a batch",)


@needs_proc
@pytest.mark.parametrize(
    "what", [pytest.param(w, marks=() if w in QUICK else pytest.mark.slow) for w in LONG]
)
def test_a_signal_ends_every_long_command_in_order(
    what: str, tree: Path, folder: Path, poisoned: dict[str, str], tmp_path: Path
) -> None:
    stall, words, number = LONG[what]
    for name in ("tree.ply", "other.ply", "rig.json", *(f"tree_{k}/trees.npz" for k in range(6))):
        (folder / name).parent.mkdir(exist_ok=True)
        os.link(tree, folder / name)
        os.link(tree, (folder / name).parent / "scan.ply") if "trees" in name else None
    env = poisoned | {"STALL": stall, "STALLED": str(tmp_path / "stalled")}
    given = [word.format(**{"in": folder, "out": tmp_path / "out"}) for word in words.split()]
    with prunus(*given, env=env) as process:
        until((tmp_path / "stalled").exists, f"a process that is at {stall}")
        process.send_signal(number)
        _, errors = process.communicate(timeout=60)
        assert process.returncode == 128 + number, errors
        until(lambda: not session(process.pid), "the end of all its processes")
    assert "Traceback" not in errors
    assert not list(tmp_path.rglob(".prunus-*"))


@needs_proc
@pytest.mark.slow
def test_a_killed_batch_leaves_no_process_and_no_folder_that_looks_whole(
    tree: Path, folder: Path, poisoned: dict[str, str], tmp_path: Path
) -> None:
    for name in ("tree.ply", "treetop.ply"):
        os.link(tree, folder / name)
    env = poisoned | {"STALL": "tree", "STALLED": str(tmp_path / "stalled")}
    with prunus("skeletonize", folder, "-o", tmp_path / "out", "--jobs", 2, env=env) as process:
        until((tmp_path / "stalled").exists, "a worker that reads")
        process.kill()
        until(lambda: not session(process.pid), "the end of all its processes")
    assert not list(tmp_path.rglob("skeleton.json"))


@posix
@pytest.mark.slow
def test_on_a_full_disk_every_input_is_told_and_nothing_is_left(
    tree: Path, folder: Path, tmp_path: Path
) -> None:
    import resource

    def full() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))

    for name in ("a", "b", "c"):
        os.link(tree, folder / f"{name}.ply")
    status, records, _ = batch(folder, tmp_path / "out", "--jobs", 2, preexec_fn=full)
    assert status == 1 and len(records) == 3
    assert all("cannot be written (File too large)" in record["error"] for record in records)
    assert [path for path in (tmp_path / "out").rglob("*") if not path.is_dir()] == []
    assert not list(tmp_path.rglob(".prunus-*"))


@posix
@pytest.mark.slow
def test_a_run_leaves_nothing_in_a_home(tree: Path, tmp_path: Path) -> None:
    from prunus.geometry.compiled import cache_dir

    (tmp_path / "home").mkdir()
    env = {"HOME": str(tmp_path / "home"), "PATH": os.environ["PATH"],
           "PYTHONPATH": os.pathsep.join(sys.path)}  # fmt: skip
    kept = cache_dir()
    if kept is not None:
        env["PRUNUS_CACHE_DIR"] = str(kept.parent)
    status, _, errors = batch(tree, tmp_path / "out", env=env)
    assert status == 0 and "telemetry" not in errors
    assert list((tmp_path / "home").iterdir()) == []


ANYBODY = 12_345
"""A user without an account, as containers and services have."""


@pytest.fixture
def as_anybody() -> Iterator[tuple[Path, dict[str, Any]]]:
    """A folder and the options of a process of a user without an account."""
    if os.name != "posix" or os.getuid() != 0:
        pytest.skip("only root may be another user")
    options: dict[str, Any] = {"user": ANYBODY, "group": ANYBODY, "extra_groups": []}
    try:
        subprocess.run([sys.executable, "-c", "import numba"], check=True, env={}, **options)
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("this Python is its owner's alone")
    with TemporaryDirectory() as folder:
        Path(folder).chmod(0o777)
        yield Path(folder), options


@pytest.mark.parametrize("home", [{}, {"HOME": "/"}, {"HOME": "/nowhere"}, {"TMPDIR": "/nowhere"}])
def test_a_user_without_an_account_is_served(
    home: dict[str, str], as_anybody: tuple[Path, dict[str, Any]]
) -> None:
    folder, options = as_anybody
    write_cloud(folder / "few.ply", np.random.default_rng(0).uniform(0, 1, (50, 3)))
    env = {"PATH": os.environ["PATH"], "PYTHONPATH": os.pathsep.join(sys.path), **home}
    status, (record,), errors = batch(folder / "few.ply", folder / "out", env=env, **options)
    assert status == 1 and "Traceback" not in errors
    assert "no tree was found" in record["error"]
