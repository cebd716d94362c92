"""Every command that finds nothing says why, and fails with status 1; an option is another's."""

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from prunus.cli import app
from prunus.io.skeletons.skeleton_file import write_skeleton
from prunus.model import RigidMotion, Skeleton
from tests.conftest import simulated
from tests.drawn import tree

RUN = CliRunner()


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A ball, a tree, a skeleton that is a base alone, and three of a drawn tree."""
    home = tmp_path_factory.mktemp("nothing")
    ways = np.random.default_rng(2).normal(size=(6000, 3))
    np.save(home / "ball.npy", 0.3 * ways / np.linalg.norm(ways, axis=1)[:, None])
    cloud = simulated(4)[1]
    np.save(home / "tree.npy", cloud.to_input.apply(cloud.xyz))
    write_skeleton(home / "alone.json", Skeleton.build([[0, 0, 0]], [-1], [0]))
    write_skeleton(home / "drawn.json", tree())
    write_skeleton(home / "beside.json", tree().moved(RigidMotion(np.eye(3), [7, 0, 0])))
    large = Skeleton.build(1000 * tree().xyz + 60, tree().parent, tree().label)
    write_skeleton(home / "large.json", large)
    return home


@pytest.mark.parametrize(
    ("words", "says"),
    [
        pytest.param("skeletonize ball.npy --frame z-up -o out", "no tree was found"),
        ("skeletonize tree.npy --frame z-up --base 9 9 9 -o out", "m from the nearest wood"),
        pytest.param("cuts ball.npy --frame z-up", "no tree was found"),
        ("skeletonize tree.npy --frame y-up -o out", "it seems to lie on its side"),
        ("skeletonize tree.npy --frame x-down -o out", "--frame z-up"),
        ("cuts tree.npy --frame optical", "it seems to lie on its side"),
        ("cuts alone.json", "holds a base alone; expected a tree to cut"),
        pytest.param(
            "isolate ball.npy --frame z-up --list",
            "no foot with branches is in view",
        ),
        pytest.param("isolate ball.npy --frame z-up -o t.ply", "a surface or a heap"),
        pytest.param(
            "isolate ball.npy --frame z-up --all -o t.ply",
            "no foot with branches is in view",
        ),
        pytest.param(
            "isolate ball.npy --frame z-up --at 0 0 -0.3 -o t.ply",
            "a surface or a heap",
        ),
        ("evaluate drawn.json alone.json", "holds a base alone; expected a tree to measure"),
        ("evaluate alone.json drawn.json", "nothing of one lies by the other"),
        ("evaluate beside.json drawn.json", "the nearest nodes are 6.30 m apart; expected two"),
        ("evaluate large.json drawn.json", "and one is 1000 times as large"),
    ],
)
def test_nothing_is_a_failure_with_a_reason(
    home: Path, words: str, says: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(home)
    done = RUN.invoke(app, words.split())
    assert done.exit_code == 1
    assert says in done.stderr
    assert not (home / "out").exists() and not list(home.glob("t*.ply"))
    assert any(word in done.stderr for word in words.split()[1:3]), "the file is named"


def test_the_line_of_a_failure_is_not_ok(home: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(home)
    done = RUN.invoke(app, ["skeletonize", "ball.npy", "--frame", "z-up", "-o", "out", "--json"])
    line = json.loads(done.stdout)
    assert (done.exit_code, line["ok"], line["skeleton"]) == (1, False, None)
    assert line["error"].startswith("ball.npy: no tree was found")


def test_one_pair_that_lies_apart_does_not_spoil_a_folder(tmp_path: Path) -> None:
    for name, moved in (("a", 0.0), ("b", 7.0)):
        found = tree().moved(RigidMotion(np.eye(3), [moved, 0, 0]))
        write_skeleton(tmp_path / "out" / f"{name}.json", found)
        write_skeleton(tmp_path / "gold" / f"{name}.json", tree())
    done = RUN.invoke(app, ["evaluate", str(tmp_path / "out"), str(tmp_path / "gold"), "--json"])
    assert done.exit_code == 0
    assert "b: nothing of one lies by the other" in done.stderr
    assert [json.loads(line)["geometry_recall"] for line in done.stdout.splitlines()] == [1, 0]
