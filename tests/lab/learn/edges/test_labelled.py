"""Learning from edges that a person labelled, played by a program that knows the tree."""

import json
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from shutil import copytree
from typing import Any

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="training needs torch: pip install 'prunus[train]'")

from prunus.errors import PrunusError  # noqa: E402
from prunus.frames.scan import open_scan  # noqa: E402
from prunus.io.labels import CATEGORIES, EdgeLabel, LabelHead, append_label  # noqa: E402
from prunus.lab.learn.edges import labelled  # noqa: E402
from prunus.lab.learn.edges.examples import true_wood  # noqa: E402
from prunus.lab.learn.edges.labelled import labelled_tree, split_by_edge  # noqa: E402
from prunus.lab.learn.edges.labels import INVALID, SOME, UNTOLD, edge_labels  # noqa: E402
from prunus.lab.learn.edges.net import Calibrated, PaperNet  # noqa: E402
from prunus.lab.learn.edges.recipes import Recipe  # noqa: E402
from prunus.lab.learn.edges.school import Course, lines_of, school  # noqa: E402
from prunus.lab.learn.edges.start import start_from  # noqa: E402
from prunus.lab.learn.edges.train import between, losses, onnx_bytes, predict  # noqa: E402
from prunus.lab.simulate.orchard import simulate_tree  # noqa: E402
from prunus.lab.simulate.scan_folder import read_scan  # noqa: E402
from prunus.paper.candidates import find_candidates  # noqa: E402
from prunus.paper.networks import SHIPPED, NetworkScorer  # noqa: E402
from prunus.params import Parameters  # noqa: E402
from prunus.pipeline import skeletonize  # noqa: E402

PARAMS = Parameters.paper().changed("input", points=8000).changed("search", K=20)
LABELS = 60


def silently(items: Iterable[Any], name: str, total: int) -> Iterable[Any]:
    return items


def label_all(scan: Path, path: Path, moved: float = 0.0) -> None:
    """Label edges of a simulated scan truly, every third without its category."""
    opened = open_scan(scan / "scan.ply")
    graph = find_candidates(skeletonize(opened.cloud, None, PARAMS).graph.superpoints)
    nodes = graph.superpoints.cloud.to_input.apply(graph.xyz)
    truth = edge_labels(nodes, graph.edges, true_wood(read_scan(scan)))
    record = {"file": "scan.ply", "sha256": opened.file.sha256, "points": len(opened.cloud)}
    head = LabelHead(input=record, params=PARAMS.model_dump(), seed=0, frame="auto")
    for k in np.random.default_rng(0).permutation(len(graph.edges))[:LABELS]:
        kind = None if truth[k] < 0 or k % 3 == 0 else CATEGORIES[truth[k]]
        ends = nodes[graph.edges[k]] + moved
        label = EdgeLabel(
            edge=tuple(graph.edges[k].tolist()),
            xyz=tuple(tuple(end) for end in ends.tolist()),
            valid=bool(truth[k] >= 0),
            category=kind,
        )
        append_label(path, head, label)


@cache
def made(root: Path) -> Path:
    """A folder with two simulated trees in `orchard`, and their labels in `studio`."""
    for seed in (3, 4):
        scan = simulate_tree(root / "orchard", seed, "clean", views=False)
        label_all(scan, root / "studio" / scan.name / "labels.jsonl")
    return root


@pytest.fixture
def studio(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return made(tmp_path_factory.getbasetemp() / "labelled") / "studio"


def test_labels_are_found_again_on_the_graph_that_the_chain_makes(
    studio: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(labelled, "VIEWS", 2)
    tree = labelled_tree(sorted(studio.glob("*/labels.jsonl"))[0], 0)
    ((first, again),) = tree.graphs
    assert (tree.labels, tree.left_out) == (LABELS, 0)
    assert int(first.told.sum()) == LABELS
    assert {INVALID, SOME} < set(first.category[first.told].tolist())
    assert np.array_equal(first.category, again.category)
    assert not np.array_equal(first.images, again.images)


def test_labels_of_another_graph_are_refused(studio: Path, tmp_path: Path) -> None:
    scan = next((studio.parent / "orchard").iterdir())
    path = tmp_path / scan.name / "labels.jsonl"
    label_all(scan, path, moved=0.01)
    with pytest.raises(PrunusError, match="none of its 60 labels is on an edge"):
        labelled_tree(path, 0, studio.parent / "orchard")


def test_a_scan_that_is_not_found_is_told(studio: Path, tmp_path: Path) -> None:
    path = copytree(studio, tmp_path / "far" / "away" / "studio")
    with pytest.raises(PrunusError, match=r"scan.ply: not found in .*--scans"):
        labelled_tree(next(path.glob("*/labels.jsonl")), 0)


def test_a_split_by_edge_shares_out_every_labelled_edge_once(
    studio: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(labelled, "VIEWS", 1)
    tree = labelled_tree(sorted(studio.glob("*/labels.jsonl"))[0], 0)
    parts = split_by_edge(tree, (0.5, 0.3, 0.2), np.random.default_rng(0))
    told = np.array([[one.told for one in part] for part in parts])[:, 0]
    assert np.array_equal(told.sum(axis=0), tree.graphs[0][0].told)
    assert (told.sum(axis=1) > 3).all()


def test_edges_of_which_nothing_was_told_have_no_part_in_the_loss() -> None:
    found = torch.randn(6, 7, requires_grad=True)
    category = torch.tensor([2, UNTOLD, INVALID, SOME, UNTOLD, 4])
    validity, kind = losses(found, category)
    (validity + kind).backward()  # type: ignore[no-untyped-call]
    assert found.grad is not None
    touched = found.grad != 0
    assert touched[:, :2].all(dim=1).tolist() == [True, False, True, True, False, True]
    assert touched[:, 2:].all(dim=1).tolist() == [True, False, False, False, False, True]
    nothing, none = losses(found.detach(), torch.full((6,), UNTOLD))
    assert float(nothing) == float(none) == 0


def test_between_two_networks_lie_their_means() -> None:
    one, other = PaperNet(), PaperNet()
    ends = [{name: own.clone() for name, own in net.state_dict().items()} for net in (one, other)]
    for share in (0.0, 1.0, 0.25):
        net = PaperNet()
        net.load_state_dict(ends[0])
        for name, own in between(net, other, share).state_dict().items():
            if own.is_floating_point():
                mean = (1 - share) * ends[0][name] + share * ends[1][name]
                assert torch.allclose(own, mean, atol=1e-6)


def test_labels_that_were_all_taken_back_are_no_examples(studio: Path, tmp_path: Path) -> None:
    path = copytree(studio, tmp_path / "studio") / "tree_000003" / "labels.jsonl"
    head, *_ = path.read_text().splitlines(keepends=True)
    path.write_text(head)
    tree = labelled_tree(path, 0, studio.parent / "orchard")
    assert (tree.graphs, tree.labels, tree.left_out) == ([], 0, 0)


def test_a_network_that_starts_from_a_file_says_what_the_file_says(studio: Path) -> None:
    recipe = Recipe()
    net = Calibrated(start_from(SHIPPED, recipe.network()), 1.0, 0.0)
    tree = labelled_tree(sorted(studio.glob("*/labels.jsonl"))[0], 0)
    example = tree.graphs[0][0]
    path = studio.parent / "paper.onnx"
    path.write_bytes(onnx_bytes(net, recipe, example))
    again = Calibrated(start_from(path, Recipe().network()), 1.0, 0.0)
    scan = open_scan(studio.parent / "orchard" / tree.name / "scan.ply")
    graph = find_candidates(skeletonize(scan.cloud, None, PARAMS).graph.superpoints)
    said = NetworkScorer(SHIPPED).judge(graph)[0][example.told]
    assert predict(net, recipe, [example])[0] == pytest.approx(said, abs=0.01)
    assert predict(again, recipe, [example])[0] == pytest.approx(said, abs=0.01)


def test_only_a_network_of_its_kind_can_be_gone_on_from(tmp_path: Path) -> None:
    with pytest.raises(PrunusError, match=r"field.onnx: parameter .*: none; expected"):
        start_from(SHIPPED.with_name("field.onnx"), PaperNet())
    (tmp_path / "net.onnx").write_bytes(b"no network")
    with pytest.raises(PrunusError, match=r"net.onnx: not an ONNX file"):
        start_from(tmp_path / "net.onnx", PaperNet())


@pytest.mark.slow
def test_labels_alone_and_with_simulated_trees_give_weights(
    studio: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(labelled, "VIEWS", 2)
    weights = tmp_path / "mine.onnx"
    report = school([studio], weights, Course(epochs=1), 1, silently)
    assert report["from"] == "paper"
    assert sum(report["labels"]) == 2 * LABELS
    assert "split by edge" in report["notes"][-1]
    assert report["before"]["edges"] == report["test"]["edges"] > 0
    assert "with" in lines_of(report)[-1]
    assert json.loads(weights.with_suffix(".json").read_text())["labels"] == report["labels"]
    both = school([studio, studio.parent / "orchard"], weights, Course(epochs=1), 1, silently)
    assert both["labels"] == report["labels"]
    assert both["edges"][0] > 1000 > report["edges"][0]
