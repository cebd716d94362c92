"""Side branches, on drawn graphs."""

import numpy as np

from prunus.model import (
    CandidateGraph,
    Label,
    PointCloud,
    ScoredGraph,
    SeededGraph,
    Skeleton,
    Superpoints,
)
from prunus.paper.sidebranches import find_side_branches
from prunus.params import Parameters
from prunus.rules import offenders
from tests.drawn import LABELS, STEP, cells, tree


def drawn_graph(picture: str) -> tuple[SeededGraph, Skeleton]:
    """A graph with an edge between all neighbours, and the skeleton without side branches.

    Letters of the skeleton first, those of the rest (`b`, and `x` for anything else) after them.
    """
    framework = tree("".join(" " if letter in "bx" else letter for letter in picture))
    letters = cells(picture)
    rest = [cell for cell, letter in letters.items() if letter in "bx"]
    lowest = np.array([min(x for x, _ in letters), 0])
    xyz = np.array([*framework.xyz, *((x * STEP, 0.0, z * STEP) for x, z in rest)])
    assert lowest[1] == 0
    far = np.linalg.norm(xyz[:, None] - xyz, axis=2)
    edges = np.argwhere(np.triu(far < 1.1 * STEP, 1))
    cloud = PointCloud.from_xyz(xyz)
    own = Superpoints.of_nodes(cloud, STEP)
    scored = ScoredGraph.of_confidence(
        CandidateGraph(own, edges), np.full(len(edges), 0.9), "drawn"
    )
    skeleton = Skeleton.build(
        cloud.xyz[: len(framework)],
        framework.parent,
        framework.label,
        superpoint=np.arange(len(framework)),
    )
    return SeededGraph(scored, 0, np.array([len(framework) - 1])), skeleton


def found(picture: str) -> int:
    """How many side-branch edges are found in a drawing."""
    graph, skeleton = drawn_graph(picture)
    grown = find_side_branches(skeleton, graph, Parameters.paper())
    assert offenders(grown) == {}
    return int(grown.edges_with(Label.SIDE_BRANCH).sum())


def test_a_branch_that_leaves_a_leader_sideways_is_found_to_its_end() -> None:
    assert found("l   \nlbbb\nl   \ns   \nt   \no   ") == 3


def test_a_single_superpoint_is_enough() -> None:
    assert found("l  \nlb \nl  \ns  \nt  \no  ") == 1


def test_one_that_leaves_the_support_is_none() -> None:
    assert found("l   \nl   \nl   \nssss\nt  x\no   ") == 0


def test_a_piece_that_also_touches_the_support_is_none_as_in_the_paper() -> None:
    graph, skeleton = drawn_graph("l   \nlxxx\nl  x\nssss\nt   \no   ")
    added = (
        find_side_branches(skeleton, graph, Parameters.paper()).edges_with(Label.SIDE_BRANCH).sum()
    )
    assert added == 0


def test_each_loose_piece_gives_its_own_branch() -> None:
    assert found("l  \nlbb\nl  \nlb \nl  \ns  \nt  \no  ") == 3


def test_nothing_loose_gives_nothing() -> None:
    assert found("l\nl\ns\nt\no") == 0


def test_the_turn_limit_ends_a_branch() -> None:
    graph, skeleton = drawn_graph("l   \nl bb\nlbb \nl   \ns   \nt   \no   ")
    strict = Parameters.paper().changed("side_branches", turn_max=0.5)
    straight = find_side_branches(skeleton, graph, strict)
    assert straight.edges_with(Label.SIDE_BRANCH).sum() == 2
    assert found("l   \nl bb\nlbb \nl   \ns   \nt   \no   ") == 4


def test_every_letter_has_a_label() -> None:
    assert set(LABELS.values()) == set(Label)
