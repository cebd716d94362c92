"""Training on a handful of scans: it learns, it repeats, and what it exports says the same."""

import json
from functools import cache
from itertools import chain
from pathlib import Path

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="training needs torch: pip install 'prunus[train]'")

from prunus.errors import PrunusError  # noqa: E402
from prunus.lab.learn.edges import examples as examples_of  # noqa: E402
from prunus.lab.learn.edges.examples import Example, example_of, split_by_tree  # noqa: E402
from prunus.lab.learn.edges.labels import TrueWood, edge_labels  # noqa: E402
from prunus.lab.learn.edges.net import PaperNet  # noqa: E402
from prunus.lab.learn.edges.recipes import Recipe  # noqa: E402
from prunus.lab.learn.edges.school import Course, school  # noqa: E402
from prunus.lab.learn.edges.train import calibrated, onnx_bytes, predict, train  # noqa: E402
from prunus.lab.simulate.orchard import simulate_tree  # noqa: E402
from prunus.model import CandidateGraph  # noqa: E402
from prunus.paper.candidates import find_candidates  # noqa: E402
from prunus.paper.networks import NetworkScorer  # noqa: E402
from prunus.paper.superpoints import find_superpoints  # noqa: E402
from prunus.params import Parameters  # noqa: E402
from tests.conftest import field_scan  # noqa: E402


@cache
def graph(seed: int) -> CandidateGraph:
    rng = np.random.default_rng(seed)
    cloud = field_scan(seed).target_cloud().sample(15_000, rng)
    return find_candidates(find_superpoints(cloud, Parameters.paper().superpoints, rng))


@cache
def example(seed: int) -> Example:
    found = graph(seed)
    nodes = found.superpoints.cloud.to_input.apply(found.xyz)
    return example_of(
        found, edge_labels(nodes, found.edges, TrueWood.of(field_scan(seed).row.trees))
    )


def test_trees_are_split_so_that_none_is_in_two_sets() -> None:
    folders = [Path(f"tree_{k}") for k in range(20)]
    parts = split_by_tree(folders, np.random.default_rng(0))
    assert [len(part) for part in parts] == [14, 4, 2]
    assert sorted(chain(*parts)) == sorted(folders)
    with pytest.raises(PrunusError, match="at least 5"):
        split_by_tree(folders[:4], np.random.default_rng(0))


def test_the_papers_network_does_not_care_how_the_image_lies() -> None:
    net = PaperNet().eval()
    images, described = torch.rand(3, 16, 32), torch.rand(3, 4)
    found = net(images, described)
    assert found.shape == (3, 7)
    for axes in [(1,), (2,), (1, 2)]:
        assert torch.allclose(net(images.flip(axes), described), found, atol=1e-6)


@pytest.mark.slow
def test_training_learns_repeats_and_exports_what_it_learnt(tmp_path: Path) -> None:
    recipe = Recipe(epochs=2, edges=1500, size=50, every=1)
    data = [example(11), example(13)]
    runs = [list(train(recipe, data, data, np.random.default_rng(0))) for _ in range(2)]
    losses = [[loss for _, loss in run] for run in runs]
    assert losses[0] == losses[1]
    assert losses[0][-1] < 0.9 * losses[0][0]
    net = calibrated(runs[0][-1][0], recipe, data)
    path = tmp_path / "mine.onnx"
    path.write_bytes(onnx_bytes(net, recipe, data[0]))
    confidence, category, _ = predict(net, recipe, data[:1])
    said, kinds = NetworkScorer(path).judge(graph(11))
    assert said == pytest.approx(confidence, abs=0.01)
    assert (kinds.argmax(axis=1) == category).mean() > 0.98


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_a_network_that_gives_something_else_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "other.onnx"
    names = {"input_names": ["image", "description"], "output_names": ["a", "b"]}
    torch.onnx.export(Swap(), (torch.rand(1), torch.rand(1)), path, dynamo=False, **names)
    with pytest.raises(PrunusError, match=r"other.onnx: a network from .* to \['a', 'b'\]"):
        NetworkScorer(path)(graph(11))


class Swap(torch.nn.Module):
    def forward(self, one: torch.Tensor, other: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        return other + 1, one + 1


def silently(items, name, total):
    return items


@pytest.mark.slow
def test_a_folder_of_scans_gives_weights_and_tables(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(examples_of, "POINTS", (8_000, 12_000))
    monkeypatch.setattr(examples_of, "GRAPHS", 1)
    for seed in range(5):
        simulate_tree(tmp_path / "orchard", seed, "hard", views=False)
    weights = tmp_path / "mine.onnx"
    report = school([tmp_path / "orchard"], weights, Course(epochs=1), 1, silently)
    assert report["trees"] == [3, 1, 1]
    written = json.loads(weights.with_suffix(".json").read_text())
    assert written["test"]["edges"] == report["test"]["edges"] > 100
    assert written["test"]["validity_accuracy"] == report["test"]["validity_accuracy"] > 0.5
    confidence = NetworkScorer(weights)(graph(11))
    assert ((confidence >= 0) & (confidence <= 1)).all()
