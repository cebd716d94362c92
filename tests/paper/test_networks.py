"""The shipped networks: what must not change their scores, and what they refuse."""

import os
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from prunus.errors import PrunusError
from prunus.model import CandidateGraph, PointCloud, Superpoints
from prunus.paper.candidates import find_candidates
from prunus.paper.confidence import score_edges
from prunus.paper.networks import NetworkScorer
from prunus.paper.superpoints import find_superpoints
from prunus.params import Parameters
from tests.conftest import field_scan


@cache
def graph(shift: tuple[float, ...] = (0.0, 0.0, 0.0), turn: float = 1.0) -> CandidateGraph:
    points = field_scan(11).target_cloud()
    xyz = points.to_input.apply(points.xyz) * [turn, turn, 1.0] + np.array(shift)
    rng = np.random.default_rng(0)
    cloud = PointCloud.from_xyz(xyz).sample(15_000, rng)
    return find_candidates(find_superpoints(cloud, Parameters.paper().superpoints, rng))


def swapped(candidates: CandidateGraph) -> CandidateGraph:
    return CandidateGraph(candidates.superpoints, candidates.edges[:, ::-1])


def test_scores_lie_between_0_and_1_and_tell_edges_apart() -> None:
    confidence, category = NetworkScorer().judge(graph())
    assert confidence.shape == (len(graph().edges),)
    assert 0 <= confidence.min() < 0.1 and 0.9 < confidence.max() <= 1
    assert category.sum(axis=1) == pytest.approx(1, abs=1e-5)


def test_moving_or_half_turning_the_cloud_does_not_change_the_score() -> None:
    scorer = NetworkScorer()
    still = scorer(graph())
    assert np.array_equal(scorer(graph(shift=(612_345.0, 5_123_456.0, 321.0))), still)
    assert np.array_equal(scorer(graph(turn=-1.0)), still)


def test_swapping_the_ends_does_not_change_the_score() -> None:
    scorer = NetworkScorer()
    assert np.abs(scorer(swapped(graph())) - scorer(graph())).max() < 0.02


def test_a_graph_without_edges_gets_no_scores() -> None:
    lone = Superpoints.of_nodes(PointCloud.from_xyz([[0.0, 0, 0]]), 0.1)
    empty = CandidateGraph(lone, np.zeros((0, 2), np.int64))
    assert NetworkScorer()(empty).shape == (0,)


def test_a_graph_brought_from_elsewhere_can_be_scored() -> None:
    nodes = Superpoints.of_nodes(PointCloud.from_xyz(np.eye(3) * 0.1), 0.1)
    two = CandidateGraph(nodes, np.array([[0, 1], [1, 2]]))
    assert np.isfinite(NetworkScorer()(two)).all()


SHIPPED = NetworkScorer().path


def other_network(inputs: dict[str, tuple[int, list[object]]], outputs: list[str]) -> bytes:
    """A network that adds up its first input, and gives that under each name."""
    onnx = pytest.importorskip("onnx")
    some = [
        onnx.helper.make_tensor_value_info(name, kind, shape)
        for name, (kind, shape) in inputs.items()
    ]
    gives = [onnx.helper.make_tensor_value_info(name, 1, [1]) for name in outputs]
    nodes = [
        onnx.helper.make_node("ReduceSum", [next(iter(inputs))], [name], keepdims=0)
        for name in outputs
    ]
    graph = onnx.helper.make_graph(nodes, "other", some, gives)
    opset = [onnx.helper.make_opsetid("", 13)]
    model = onnx.helper.make_model(graph, opset_imports=opset, ir_version=8)
    return model.SerializeToString()


ASKED = {"image": (1, ["E", 16, 32]), "description": (1, ["E", 4])}
OTHERS = {
    "text": (lambda: b"not a network", "not an ONNX file"),
    "nothing": (lambda: b"", "the file is empty"),
    "json": (lambda: b'{"K": 1}', "not an ONNX file"),
    "cut off": (lambda: SHIPPED.read_bytes()[:-2000], "not an ONNX file"),
    "half": (lambda: SHIPPED.read_bytes()[: len(SHIPPED.read_bytes()) // 2], "not an ONNX file"),
    "of points": (SHIPPED.with_name("field.onnx").read_bytes, "a network from "),
    "of pictures": (
        lambda: other_network({"input": (1, [1, 3, 8, 8])}, ["logits"]),
        r"a network from \['input'\] to \['logits'\]; expected one that `prunus train` made",
    ),
    "of other sizes": (
        lambda: other_network(ASKED | {"image": (1, ["E", 8, 8])}, ["confidence", "category"]),
        "the network does not take what it is shown",
    ),
    "of other kinds": (
        lambda: other_network(ASKED | {"image": (7, ["E", 16, 32])}, ["confidence", "category"]),
        "not an ONNX file|the network does not take what it is shown",
    ),
    "of another answer": (
        lambda: other_network(ASKED, ["confidence", "category"]),
        r"confidence: shape \(\); expected",
    ),
}


@pytest.mark.parametrize("kind", OTHERS)
def test_weights_that_are_none_are_refused_by_name(kind: str, tmp_path: Path) -> None:
    make, says = OTHERS[kind]
    path = tmp_path / "mine.onnx"
    path.write_bytes(make())
    with pytest.raises(PrunusError, match=f"mine.onnx: {says}"):
        score_edges(graph(), NetworkScorer(path))


def test_a_missing_file_or_a_folder_is_refused(tmp_path: Path) -> None:
    for path in (tmp_path / "none.onnx", tmp_path):
        with pytest.raises(PrunusError, match=f"{path.name}: cannot be read"):
            NetworkScorer(path)(graph())
    with pytest.raises(PrunusError, match="network: 5; expected the name of an ONNX file"):
        NetworkScorer(5)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes here")
def test_a_pipe_is_refused_and_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.onnx")
    with pytest.raises(PrunusError, match=r"pipe.onnx: a pipe or a device; expected a file"):
        NetworkScorer(tmp_path / "pipe.onnx").check()


def test_own_weights_may_be_named_by_text() -> None:
    scorer = NetworkScorer(str(SHIPPED))
    assert np.array_equal(scorer(graph()), NetworkScorer()(graph()))
