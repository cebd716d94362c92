"""`search_graph`: drawn graphs give the drawn labels; bad arguments are refused by name."""

import numpy as np
import pytest

import prunus
from prunus.errors import PrunusError
from tests.drawn import STEP, TREE, cells, tree

COARSE = 1.5
"""Drawn cells are this many times farther apart, so that rewards outweigh penalties."""


def drawn(picture: str) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and the edges between neighbouring cells, side by side or one above the other."""
    places = list(cells(picture))
    nodes = np.array([(x * STEP * COARSE, 0.0, z * STEP * COARSE) for x, z in places])
    edges = [
        (i, j)
        for i, (x, z) in enumerate(places)
        for j, (u, w) in enumerate(places)
        if i < j and abs(x - u) + abs(z - w) == 1
    ]
    return nodes, np.array(edges)


def test_a_drawn_tree_gets_the_drawn_labels() -> None:
    picture = TREE.replace("b", " ")
    nodes, edges = drawn(picture)
    base = list(cells(picture).values()).index("o")
    found = prunus.search_graph(nodes, edges, np.ones(len(edges)), base)
    expected = tree(picture)
    at = {
        tuple(np.round(xyz * COARSE, 6)): label
        for xyz, label in zip(expected.xyz, expected.label, strict=True)
    }
    for (_, below), word in zip(found.edges, found.labels, strict=True):
        label = prunus.Label(at[tuple(np.round(nodes[below], 6))])
        assert word == label.word or {word, label.word} <= {"trunk", "support"}
    assert len(found.edges) == len(nodes) - 1
    assert found.score == pytest.approx(len(edges) * STEP * COARSE, rel=0.2)
    assert found.score >= found.history.max()


def test_a_gap_is_crossed_and_a_loop_is_cut() -> None:
    nodes, edges = drawn("x x\nx x\nxxx\n x \n x ")
    confidence = np.where(np.arange(len(edges)) == 4, 0.2, 0.9)
    found = prunus.search_graph(nodes, edges, confidence, len(nodes) - 1)
    assert len(found.edges) == len(nodes) - 1
    assert len(np.unique(found.edges[:, 1])) == len(found.edges)


def test_two_tips_in_one_place_and_tips_out_of_reach_do_no_harm() -> None:
    nodes = np.array([[0.0, 0, 0], [0, 0, 0.15], [0, 0, 0.3], [0, 0, 0.3], [5, 0, 5.0]])
    edges = [(0, 1), (1, 2), (1, 3)]
    found = prunus.search_graph(nodes, edges, [0.9] * 3, 0, tips=[2, 3, 4, 2])
    assert found.edges.tolist()[0] == [0, 1]
    assert 4 not in found.edges


def test_the_same_seed_gives_the_same_answer() -> None:
    nodes, edges = drawn(TREE)
    twice = [
        prunus.search_graph(nodes, edges, np.ones(len(edges)), len(nodes) - 1, seed=5)
        for _ in range(2)
    ]
    assert np.array_equal(twice[0].edges, twice[1].edges)
    assert twice[0].score == twice[1].score


NODES = np.array([[0.0, 0, 0], [0, 0, 0.15], [0, 0, 0.3]])
EDGES = [(0, 1), (1, 2)]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"nodes": NODES[:, :2]}, r"nodes: shape \(3, 2\); expected \(N, 3\)"),
        ({"edges": [(0, 1, 2)]}, r"edges: shape \(1, 3\); expected \(N, 2\)"),
        ({"edges": [(0, 1), (1, 7)]}, "edges: holds 0 to 7; expected 0 to 2"),
        ({"edges": [(0, 1), (1, 0)]}, "edges: a pair stands twice"),
        ({"edges": [(0, 1), (1, 1)]}, "edges: one joins a node to itself"),
        ({"edges": [(0.5, 1), (1, 2)]}, "edges: float64; expected integers"),
        ({"confidence": [0.5]}, r"confidence: shape \(1,\); expected \(2,\)"),
        ({"confidence": [0.5, 1.5]}, "expected 2 numbers from 0 to 1"),
        ({"confidence": [0.5, np.nan]}, "expected 2 numbers from 0 to 1"),
        ({"base": 9}, "base: holds 9 to 9; expected 0 to 2"),
        ({"tips": [9]}, "tips: holds 9 to 9"),
        ({"tips": [0]}, "tips: none found"),
    ],
)
def test_bad_arguments_are_refused_by_name(change: dict, message: str) -> None:
    given = {"nodes": NODES, "edges": EDGES, "confidence": [0.9, 0.9], "base": 0} | change
    with pytest.raises(PrunusError, match=message):
        prunus.search_graph(**given)
