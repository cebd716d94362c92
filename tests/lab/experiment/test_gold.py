"""The experiment on trees that a person corrected, here a branch taken away and a tree done."""

import json
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from prunus.editing import RemoveBranch, SetStatus
from prunus.errors import PrunusError
from prunus.io.labels import EdgeLabel, LabelHead, append_label
from prunus.lab.experiment.gold import Corrected, corrected_in, with_nodes_every
from prunus.lab.experiment.orchard import Tree
from prunus.lab.experiment.results import Orchard, experiment, lines_of
from prunus.lab.experiment.trial import BY_HAND, WAYS
from prunus.lab.simulate.orchard import simulate_tree
from prunus.model import Label
from prunus.model.branches import branches
from prunus.params import Parameters
from prunus.session import Work
from prunus.session.sources import Settings
from tests.drawn import tree as drawn_tree

PARAMS = Parameters.paper().changed("input", points=8000).changed("search", K=20)


@cache
def made(root: Path) -> Path:
    """The studio's work folder: `tree_000003` corrected and done, `tree_000004` in work."""
    for seed in (3, 4):
        scan = simulate_tree(root / "orchard", seed, "clean", views=False)
        with Work.open(
            scan / "scan.ply", root / "studio" / scan.name, Settings(params=PARAMS)
        ) as work:
            side = branches(work.machine, Label.SIDE_BRANCH)[-1]
            work.do(RemoveBranch(int(work.machine.superpoint[side.rows[1]])))
            work.do(SetStatus(seed == 3))
            if seed == 3:
                label_one(work)
    return root


def label_one(work: Work) -> None:
    graph = work.state.result.graph
    i, j = graph.edges[0].tolist()
    ends = work.state.scan.to_input.apply(graph.xyz[[i, j]]).tolist()
    head = LabelHead(
        input=work.scan.record, params=PARAMS.model_dump(), seed=0, frame=work.settings.frame
    )
    label = EdgeLabel(edge=(i, j), xyz=tuple(map(tuple, ends)), valid=True, category="leader")
    append_label(work.folder / "labels.jsonl", head, label)


@pytest.fixture(scope="module")
def studio(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return made(tmp_path_factory.mktemp("gold")) / "studio"


@pytest.fixture(scope="module")
def folder(studio: Path) -> Path:
    orchard = Orchard.corrected(studio, None)
    experiment(studio.parent / "out", orchard, 1, False, 1, lambda items, name, total: items)
    return studio.parent / "out"


def test_only_trees_that_are_done_are_gold(studio: Path) -> None:
    done, in_work = corrected_in(studio)
    assert [one.name for one in done] == ["tree_000003"]
    assert in_work == ["tree_000004"]
    assert "left out: tree_000004" in Orchard.corrected(studio, None).about


def test_a_folder_without_corrections_is_told(tmp_path: Path) -> None:
    with pytest.raises(PrunusError, match="0 corrected trees"):
        corrected_in(tmp_path)
    with pytest.raises(PrunusError, match="no folder"):
        corrected_in(tmp_path / "none")


def test_the_edits_by_hand_are_those_that_the_person_made(studio: Path) -> None:
    subject = Corrected(studio / "tree_000003", None)
    (record,) = subject.by_hand()
    removed = record["edits"]["wrong"]
    assert removed >= 1
    assert (record["edits"]["missing"], record["edits"]["mislabelled"]) == (0, 0)
    assert record["edit_ratio"] == removed / record["edits"]["edges"]
    assert record["branches"]["base_error"] == 0


def test_every_way_is_tried_against_the_corrected_skeleton(folder: Path) -> None:
    held = json.loads((folder / "results.json").read_text())
    assert list(held["ways"]) == [BY_HAND, *(way.name for way in WAYS)]
    by_hand, ours = held["ways"][BY_HAND], held["ways"]["default"]
    assert by_hand["cpu_s"]["median"] is None
    assert ours["leaders_found"] > 0.3
    assert held["ways"]["paper, oracle"]["failed"] == 0
    assert held["edges"]["edges"] == 1
    assert (folder / "index.html").read_text().count("<svg") == 8
    tables = [line for line in lines_of(held) if line.startswith("|")]
    assert BY_HAND in tables[0]


def test_a_correction_makes_the_tree_another_one(studio: Path) -> None:
    subject = Corrected(studio / "tree_000004", None)
    before = subject.made_of
    with Work.open(studio.parent / "orchard" / subject.name / "scan.ply", subject.folder) as work:
        work.do(SetStatus(True))
        work.undo()
    assert subject.made_of != before


def test_the_points_are_those_of_the_tree_and_the_truth_lies_among_them(studio: Path) -> None:
    tree: Tree = Corrected(studio / "tree_000003", None).tree()
    points = tree.cloud.to_input.apply(tree.cloud.xyz)
    low, high = points.min(axis=0) - 0.1, points.max(axis=0) + 0.1
    assert ((tree.truth.xyz > low) & (tree.truth.xyz < high)).all()
    assert len(tree.cloud) > 1000


def test_more_nodes_change_no_length_no_label_and_no_place() -> None:
    few = drawn_tree()
    many = with_nodes_every(few, 0.02)
    assert len(many) > 2 * len(few)
    assert many.lengths.max() <= 0.02 + 1e-9
    for label in Label:
        lengths = [tree.lengths[tree.edges_with(label)].sum() for tree in (few, many)]
        assert lengths[0] == pytest.approx(lengths[1])
    assert all(np.abs(many.xyz - place).sum(axis=1).min() < 1e-9 for place in few.xyz)
