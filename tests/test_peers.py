"""TreeQSM is called in another Python; here a few lines stand for PyTLidar there."""

import argparse
import os
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from bench import peers
from bench.set_cases import Case
from bench.set_methods import Found, tried

from prunus.errors import PrunusError
from tests.drawn import tree

ONE_CYLINDER = """
import numpy as np

def build_inputs(xyz, counts, **options):
    return [{"counts": counts}]

def run_qsm(xyz, inputs, folder):
    stem = {"start": xyz[:1], "axis": np.array([[0.0, 0.0, 1.0]]), "radius": np.array([0.02])}
    stem |= {"length": np.ptp(xyz[:, 2])[None], "parent": np.array([-1])}
    worse = {name: 2 * column for name, column in stem.items()}
    return [{"cylinder": worse}, {"cylinder": stem, "counts": inputs["counts"]}], []

def calculate_optimal(models, metric):
    assert metric == "all_mean_dis" and models[1]["counts"] == (1, 2, 3)
    return 1, 0.0, None
"""
CRASHES = "import os\nos._exit(7)"
RAISES = """
calculate_optimal = run_qsm = None

def build_inputs(*words, **options):
    raise ValueError("no stem")
"""
ENDLESS = "while True:\n    pass"
CLOUD = np.column_stack([np.full(30, 5.0), np.full(30, -2.0), np.linspace(1, 3, 30)])
Standing = Callable[[str], None]


@pytest.fixture
def standing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Standing:
    """What is to stand for PyTLidar, whether or not it is installed here."""
    path = os.pathsep.join([str(tmp_path), *filter(None, [os.environ.get("PYTHONPATH")])])
    monkeypatch.setenv("PYTHONPATH", path)

    def put(text: str) -> None:
        (tmp_path / "PyTLidar.py").write_text(text)

    return put


def test_its_best_model_comes_back_in_the_frame_of_the_cloud(standing: Standing) -> None:
    standing(ONE_CYLINDER)
    options = argparse.Namespace(python=sys.executable, inputs=(1, 2, 3), limit=60.0)
    found, _ = tried(peers.treeqsm(options), CLOUD, None)
    assert found is not None
    assert found.kept is None
    assert found.skeleton.xyz == pytest.approx(np.array([[5, -2, 1], [5, -2, 3]]))
    assert found.skeleton.radius == pytest.approx(0.02)


@pytest.mark.parametrize(
    ("text", "limit_s", "said"),
    [
        (CRASHES, 60.0, "TreeQSM: it ended with 7"),
        (RAISES, 60.0, "TreeQSM: ValueError: no stem"),
        (ENDLESS, 1.0, "TreeQSM: not done in 1 s"),
    ],
)
def test_what_it_cannot_do_is_said_and_is_no_skeleton(
    standing: Standing, text: str, limit_s: float, said: str
) -> None:
    standing(text)
    with pytest.raises(PrunusError, match=said):
        peers.cylinders_of(CLOUD, sys.executable, (1, 1, 1), limit_s)


def test_nothing_that_asks_for_labels_is_measured() -> None:
    whole = tree()
    every = np.ones(len(whole), np.bool_)
    case = Case("drawn", whole.xyz, every, whole, every, np.zeros((0, 3)))
    right, none = peers.geometry_of(case, Found(whole)), peers.geometry_of(case, None)
    assert right == {"failed": 0, "geometry": 0, "unasked": 0, "f1 2": 1, "f1 5": 1, "base": 0}
    assert (none["failed"], none["geometry"], none["f1 5"]) == (1, 1, 0)


@pytest.mark.parametrize(
    ("python", "why"),
    [
        (sys.executable, "ModuleNotFoundError: No module named 'numba'"),
        ("no/such/python", "no/such/python cannot run PyTLidar"),
    ],
)
def test_where_it_is_not_installed_it_says_how_to(
    standing: Standing,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    python: str,
    why: str,
) -> None:
    standing("raise ModuleNotFoundError(\"No module named 'numba'\")")
    monkeypatch.setattr(sys, "argv", ["peers", "--python", python])
    with pytest.raises(SystemExit) as ended:
        peers.main()
    said = capsys.readouterr().err
    assert ended.value.code == 2
    assert why in said
    assert "pip install pytlidar" in said
    assert "--python" in said
