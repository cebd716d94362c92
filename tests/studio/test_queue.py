from pathlib import Path

import numpy as np
import pytest

from prunus.editing import Brush, Mark, PickBase, Rebuild
from prunus.errors import PrunusError
from prunus.io.labels import LabelHead, read_labels
from prunus.lab.learn.edges.labelled import labelled_graphs
from prunus.model import (
    CandidateGraph,
    Kind,
    PointCloud,
    RigidMotion,
    ScoredGraph,
    Superpoints,
)
from prunus.params import Parameters
from prunus.session import Settings, Work
from prunus.studio.modes.label import queue_of
from prunus.studio.queue import Queue

SURE = [0.9, 0.52, 0.1, 0.4]
SHIFT = RigidMotion(np.eye(3), np.array([10.0, 0.0, 0.0]))


def queue(path: Path) -> Queue:
    """Four edges of a chain of five superpoints."""
    xyz = np.arange(5)[:, None] * [0.1, 0.0, 0.0]
    under = Superpoints.of_nodes(PointCloud(xyz, SHIFT), 0.1)
    edges = np.column_stack([np.arange(4), np.arange(1, 5)])
    graph = ScoredGraph.of_confidence(CandidateGraph(under, edges), np.array(SURE), "drawn")
    record = {"file": "x.ply", "sha256": "0", "points": 5}
    head = LabelHead.model_validate({"input": record, "params": {}, "seed": 0, "frame": "z-up"})
    return Queue.of(graph, SHIFT, path / "labels.jsonl", head)


def test_the_uncertain_come_first(tmp_path: Path) -> None:
    asked = queue(tmp_path)
    order = []
    for _ in SURE:
        order.append(asked.edge)
        asked.say(True, None)
    assert order == [1, 3, 0, 2]
    assert len(asked.given) == 4


def test_what_was_said_is_found_again_and_not_asked_twice(tmp_path: Path) -> None:
    one = queue(tmp_path)
    one.say(True, "leader")
    one.say(False, None)
    again = queue(tmp_path)
    assert again.given == {1: (True, "leader"), 3: (False, None)}
    assert again.edge == 0
    assert again.verdict(1) == "valid, leader" and again.verdict(3) == "not valid"


def test_labels_name_superpoints_and_places_of_the_file(tmp_path: Path) -> None:
    queue(tmp_path).say(True, "other")
    label = read_labels(tmp_path / "labels.jsonl").labels[0]
    assert label.edge == (1, 2)
    assert np.ravel(label.xyz) == pytest.approx([10.1, 0, 0, 10.2, 0, 0])


def test_one_goes_back_changes_ones_mind_and_takes_it_back(tmp_path: Path) -> None:
    asked = queue(tmp_path)
    asked.say(True, None)
    asked.back()
    assert asked.edge == 1
    asked.say(False, None)
    asked.jump(1)
    asked.say(None, None)
    assert asked.verdict(1) == "not labelled" and asked.edge == 1
    assert queue(tmp_path).given == {}
    asked.skip()
    assert asked.edge == 3


def test_edges_of_a_tree_that_was_cleaned_are_learned_from_too(
    orchard: Path, tmp_path: Path
) -> None:
    paper = Settings(params=Parameters.paper())
    with Work.open(orchard / "oak.ply", tmp_path / "oak", paper) as work:
        asked = queue_of(work)
        assert asked.graph.confidence.min() <= work.state.result.graph.confidence.min()
        asked.say(True, "leader")
        xyz = work.state.scan.to_input.apply(work.state.scan.xyz)
        foot, tip = (tuple(xyz[row].tolist()) for row in (xyz[:, 2].argmin(), xyz[:, 2].argmax()))
        work.do(PickBase(foot))
        work.do(Rebuild())
        with pytest.raises(PrunusError, match="from another base"):
            queue_of(work)
        work.undo()
        work.undo()
        work.do(Mark(Brush((tip,), 0.2), Kind.STRAY))
        work.do(Rebuild())
        queue_of(work).say(False, None)
    held = read_labels(tmp_path / "oak" / "labels.jsonl")
    graphs, over = labelled_graphs(held, orchard)
    assert (len(graphs), over) == (2, [])
