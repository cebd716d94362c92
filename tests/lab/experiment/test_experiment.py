"""The experiment on one tree: what is written, that it resumes, and that its sums are right."""

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from prunus.lab.experiment.orchard import Simulated
from prunus.lab.experiment.results import Orchard, experiment, lines_of
from prunus.lab.experiment.run import run_tree
from prunus.lab.experiment.tables import edit_ratios, spread, way_of
from prunus.lab.experiment.trial import WAYS


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("experiment")
    orchard = Orchard.simulated(1, "clean", 0)
    experiment(folder, orchard, 1, False, 1, lambda items, name, total: items)
    return folder


@pytest.mark.slow
def test_every_way_is_tried_and_written(folder: Path) -> None:
    held = json.loads((folder / "results.json").read_text())
    names = [way.name for way in WAYS]
    assert list(held["ways"]) == names
    assert [trial["way"] for trial in held["trials"]] == names
    with (folder / "trials.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["way"] for row in rows] == names
    ratio = held["ways"]["default"]["edit_ratio"]["median"]
    assert float(rows[1]["edit_ratio"]) == pytest.approx(ratio)


@pytest.mark.slow
def test_every_trial_has_its_edits_by_length_and_the_tables_show_them(folder: Path) -> None:
    held = json.loads((folder / "results.json").read_text())
    for trial in held["trials"]:
        metres = trial["by_length"]
        parts = metres["wrong"] + metres["missing"] + metres["mislabelled"]
        assert metres["ratio"] == pytest.approx(parts / metres["length"])
        assert metres["geometry_ratio"] <= metres["ratio"]
    assert held["ways"]["default"]["by_length"]["number"] == 1
    assert "edit ratio by length, median" in (folder / "results.md").read_text()


@pytest.mark.slow
def test_on_a_clean_scan_ours_needs_fewer_edits_than_the_paper(folder: Path) -> None:
    ways = json.loads((folder / "results.json").read_text())["ways"]
    assert ways["default"]["edit_ratio"]["median"] < ways["paper"]["edit_ratio"]["median"]


@pytest.mark.slow
def test_the_page_holds_tables_and_figures_and_needs_no_network(folder: Path) -> None:
    page = (folder / "index.html").read_text()
    assert page.count("<svg") == 8
    assert "http" not in page
    assert "edit ratio, median" in (folder / "results.md").read_text()


@pytest.mark.slow
def test_what_is_done_is_not_done_again(folder: Path) -> None:
    path = next((folder / "trees").iterdir())
    held = json.loads(path.read_text())
    held["trials"][0]["edit_ratio"] = 0.125
    path.write_text(json.dumps(held))
    tree = Simulated(900_000, "clean")
    assert run_tree(folder, tree, 1)["trials"][0]["edit_ratio"] == 0.125
    held["made_by"] = "another version"
    path.write_text(json.dumps(held))
    assert run_tree(folder, tree, 1)["trials"][0]["edit_ratio"] != 0.125


def test_a_trial_without_a_skeleton_counts_as_all_wrong() -> None:
    failed: dict[str, Any] = {"tree": "a", "way": "paper", "habits": [], "error": "no tips"}
    assert edit_ratios([failed]) == [1.0]
    found = way_of([failed])
    assert found["failed"] == 1
    assert found["edit_ratio"]["median"] == 1.0
    assert found["by_length"]["median"] == found["geometry_by_length"]["median"] == 1.0


def test_the_spread_leaves_out_what_is_no_number() -> None:
    found = spread([1.0, np.nan, 3.0, 2.0])
    assert (found["median"], found["least"], found["most"], found["number"]) == (2, 1, 3, 3)
    assert spread([])["median"] is None


@pytest.mark.slow
def test_tables_are_markdown(folder: Path) -> None:
    held = json.loads((folder / "results.json").read_text())
    tables = [line for line in lines_of(held) if line.startswith("|")]
    assert len({line.count("|") for line in tables}) <= 3
