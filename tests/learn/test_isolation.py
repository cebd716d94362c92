"""Learning isolation: examples from simulated rows, a network that learns, and its file."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("torch")
pytest.importorskip("onnx")

from prunus.io.scans import read_scan
from prunus.learn import examples, isolation
from prunus.learn.isolation import (
    RowExample,
    kept_and_removed,
    lowest_seen,
    row_examples_in,
    turned_at_random,
)
from prunus.learn.school import Course, isolation_school
from prunus.model import Kind
from prunus.networks import open_network
from prunus.sensing.isolate import SHOWN, TOLD
from prunus.simulate.orchard import simulate_tree


@pytest.fixture(scope="module")
def orchard(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("orchard")
    for seed in range(5):
        simulate_tree(folder, seed, "hard", views=False)
    return folder


@pytest.fixture(scope="module")
def example(orchard: Path) -> RowExample:
    return row_examples_in(orchard / "tree_000000", 0)[0]


def test_every_point_near_a_superpoint_counts_for_its_tree_or_thing(
    example: RowExample, orchard: Path
) -> None:
    scan = read_scan(orchard / "tree_000000")
    kinds = example.kinds(0)
    assert kinds.sum() <= len(scan.xyz)
    for kind in (Kind.TARGET, Kind.BEHIND, Kind.GROUND):
        assert kinds[:, kind].sum() == pytest.approx((scan.kind == kind).sum(), rel=0.05)


def test_seen_from_the_row_behind_the_target_is_behind(example: RowExample) -> None:
    other = next(tree for tree in example.asked if example.behind[tree])
    target, back = example.kinds(0), example.kinds(other)
    assert back[:, Kind.BEHIND].sum() >= target[:, Kind.TARGET].sum()
    assert back[:, Kind.GROUND].sum() == target[:, Kind.GROUND].sum()
    assert back.sum() == target.sum()


def test_the_base_is_the_lowest_of_the_trunk_that_is_seen(orchard: Path) -> None:
    scan = read_scan(orchard / "tree_000000")
    base = lowest_seen(scan, 0)
    trunk = scan.xyz[(scan.tree == 0) & (scan.branch == 0)]
    assert base[2] == pytest.approx(trunk[:, 2].min(), abs=0.05)


def test_turns_are_small_or_half_round_and_keep_lengths(rng: np.random.Generator) -> None:
    for _ in range(20):
        turn = turned_at_random(rng)
        assert turn @ turn.T == pytest.approx(np.eye(3))
        assert turn[2, 2] > np.cos(np.radians(15))


def silently(items: Iterable[Any], name: str, total: int) -> Iterable[Any]:
    return items


@pytest.mark.slow
def test_a_folder_of_scans_gives_a_network_that_tells_kinds(
    orchard: Path, tmp_path: Path, example: RowExample, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(examples, "POINTS", (10_000, 20_000))
    weights = tmp_path / "mine.onnx"
    report = isolation_school([orchard], weights, Course(epochs=3), 1, silently)
    assert report["trees"] == [4, 1]
    assert report["losses"][-1] < 0.8 * report["losses"][0]
    assert weights.with_suffix(".json").exists()
    onward = Course(epochs=1, start=str(weights))
    again = isolation_school([orchard], tmp_path / "more.onnx", onward, 1, silently)
    assert again["losses"][0] < 0.8 * report["losses"][0]
    seen = example.pieces.seen_from(example.base[0])
    told = {"node": seen.node, "near": seen.near, "link": seen.link}
    kinds = open_network(weights, SHOWN, TOLD).run(["kind"], told)[0]
    assert kinds.shape == (len(example.pieces.xyz), len(Kind))
    assert kinds.sum(axis=1) == pytest.approx(1, abs=1e-4)


def test_what_was_kept_and_removed_is_counted_in_points(example: RowExample) -> None:
    class Everything(isolation.IsolationNet):
        def forward(self, node, near, link):  # type: ignore[no-untyped-def]
            kinds = isolation.torch.zeros(len(node), len(Kind))
            kinds[:, Kind.TARGET] = 1
            return kinds

    assert kept_and_removed(Everything(), [example]) == pytest.approx((1, 0))
