"""A skeleton is a tree by construction, frozen, and a change is a new value."""

import numpy as np
import pytest

from prunus.model import Label, RigidMotion, Skeleton
from tests.drawn import tree


def test_a_drawn_tree_has_the_drawn_lengths() -> None:
    skeleton = tree("l\nl\nst\n o")
    assert [int(label) for label in skeleton.label] == [0, 0, 1, 2, 2]
    assert skeleton.lengths == pytest.approx([0, 0.1, 0.1, 0.1, 0.1])
    assert skeleton.edges.tolist() == [[0, 1], [1, 2], [2, 3], [3, 4]]


@pytest.mark.parametrize(
    ("parent", "message"),
    [
        ([-1, 1], r"parent\[1\] is 1; expected -1 at row 0 and an earlier row"),
        ([-1, -1], r"parent\[1\] is -1"),
        ([0, 0], r"parent\[0\] is 0"),
    ],
)
def test_a_cycle_or_a_second_root_cannot_be_written(parent: list[int], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Skeleton.build(np.eye(3)[:2], parent, [0, 0])


def test_no_nodes_unknown_labels_and_nan_are_refused() -> None:
    with pytest.raises(ValueError, match="at least its base"):
        Skeleton.build(np.zeros((0, 3)), [], [])
    with pytest.raises(ValueError, match="labels are 0 to 3"):
        Skeleton.build(np.zeros((1, 3)), [-1], [7])
    with pytest.raises(ValueError, match="NaN or infinity"):
        Skeleton.build([[0, 0, np.nan]], [-1], [0])
    with pytest.raises(ValueError, match=r"parent: shape \(1,\); expected \(2,\)"):
        Skeleton.build(np.zeros((2, 3)), [-1], [0, 0])


def test_arrays_are_frozen_and_a_change_is_a_new_value() -> None:
    skeleton = tree()
    with pytest.raises(ValueError, match="read-only"):
        skeleton.xyz[0] = 1
    thicker = skeleton.with_radius(np.full(len(skeleton), 0.02))
    assert np.isnan(skeleton.radius).all()
    assert (thicker.radius == 0.02).all()


def test_motion_there_and_back_changes_nothing() -> None:
    turn = RigidMotion(np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]]), np.array([1.0, 2, 3]))
    skeleton = tree()
    there = skeleton.moved(turn)
    assert there.moved(turn.inverse()).xyz == pytest.approx(skeleton.xyz)
    assert there.lengths == pytest.approx(skeleton.lengths)


def test_networkx_holds_every_column() -> None:
    skeleton = tree()
    graph = skeleton.to_networkx()
    assert graph.number_of_edges() == len(skeleton) - 1
    words = [data["label"] for _, _, data in graph.edges(data=True)]
    assert words.count("leader") == skeleton.edges_with(Label.LEADER).sum()
    assert [graph.nodes[0][axis] for axis in "xyz"] == skeleton.xyz[0].tolist()
    assert "radius" not in graph.nodes[0], "it is unknown"


def test_words_and_labels_name_each_other() -> None:
    assert [Label.from_word(label.word) for label in Label] == list(Label)
    with pytest.raises(ValueError, match="unknown label 'twig'"):
        Label.from_word("twig")
