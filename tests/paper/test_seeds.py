"""A base given by hand: on wood that may be a foot, or why not."""

import numpy as np
import pytest

from prunus.errors import PrunusError
from prunus.model import CandidateGraph, Floats, Label, PointCloud, ScoredGraph, Superpoints
from prunus.paper.seeds import doubts_of_base, find_seeds, nearest_superpoint, out_of_weeds
from prunus.params import Parameters

FAR = np.array([31.0, -7.0, 2.0])
"""The trunk stands there in the file."""


def graph(frame: str = "z-up", kinds: bool = True, foot: Floats = FAR) -> ScoredGraph:
    """A trunk of 1 m, a leader of 1 m on it, and a shoot of 1 m that hangs from its top."""
    trunk = [(0, 0, z) for z in np.arange(0, 1.01, 0.1)]
    leader = [(0, 0, z) for z in np.arange(1.1, 2.01, 0.1)]
    shoot = [(x, 0, 2 - 0.2 * x) for x in np.arange(0.1, 1.01, 0.1)]
    to_file = {"z-up": np.eye(3), "optical": np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]]).T}
    xyz = (np.array([*trunk, *leader, *shoot]) + foot) @ to_file[frame].T
    cloud = PointCloud.from_xyz(xyz, frame)
    edges = np.array([(i, i + 1) for i in range(len(xyz) - 1)])
    category = np.zeros((len(edges), 5))
    label = [Label.TRUNK] * 10 + [Label.LEADER] * 10 + [Label.SIDE_BRANCH] * 10
    category[np.arange(30), label] = 1
    candidates = CandidateGraph(Superpoints.of_nodes(cloud, 0.1), edges)
    category = category if kinds else category[:, :0]
    return ScoredGraph(
        candidates=candidates, confidence=np.full(30, 0.9), category=category, scorer="drawn"
    )


def at(scored: ScoredGraph, place: Floats) -> Floats:
    """A place of the file in the house frame."""
    return scored.candidates.superpoints.cloud.to_input.inverse().apply(place)


@pytest.mark.parametrize("kinds", [True, False])
@pytest.mark.parametrize("below", [0.21, 0.35, 0.5])
def test_a_foot_that_weeds_hide_is_taken_with_a_note(below: float, kinds: bool) -> None:
    scored = graph(kinds=kinds)
    base, notes = out_of_weeds(scored, at(scored, FAR - np.array([0.02, 0.05, below])))
    assert base == pytest.approx(scored.xyz[0])
    assert f"is {below:.2f} m below the lowest wood in view" in notes[0]


@pytest.mark.parametrize("away", [(0, 0, -0.7), (0.3, 0, -0.3), (1.0, 0, 1.4), (0, 0, 2.4)])
def test_no_foot_is_taken_from_afar_or_under_thin_wood(away: tuple[float, ...]) -> None:
    scored = graph()
    base = at(scored, FAR + away)
    assert out_of_weeds(scored, base) == (base, [])
    with pytest.raises(PrunusError, match="m from the nearest part of the tree"):
        find_seeds(scored, Parameters.paper(), base)


@pytest.mark.parametrize("frame", ["z-up", "optical"])
def test_a_base_near_wood_is_taken_as_it_is(frame: str) -> None:
    scored = graph(frame)
    for place in (scored.xyz[0], scored.xyz[0] - [0, 0, 0.19]):
        assert out_of_weeds(scored, place) == (place, [])
        assert nearest_superpoint(scored, place) == 0


@pytest.mark.parametrize(
    ("frame", "given", "meant"),
    [
        ("z-up", FAR * 1000, "is it given in millimetres?"),
        ("z-up", FAR * 100, "is it given in centimetres?"),
        ("z-up", FAR / 0.3048, "is it given in feet?"),
        ("optical", FAR, "is it given in the frame z-up?"),
        ("z-up", FAR + np.array([9, 9, 0]), r"frame of the file\)$"),
    ],
)
def test_a_base_far_off_says_how_it_may_have_been_meant(
    frame: str, given: Floats, meant: str
) -> None:
    scored = graph(frame)
    with pytest.raises(PrunusError, match=meant):
        nearest_superpoint(scored, at(scored, given))


def test_of_a_tree_at_the_origin_no_unit_is_guessed() -> None:
    """Any base is near the origin, in millimetres."""
    scored = graph(foot=np.zeros(3))
    with pytest.raises(PrunusError, match=r"frame of the file\)$"):
        nearest_superpoint(scored, np.array([1.4, 0.9, -1.4]))


@pytest.mark.parametrize(
    ("node", "says"),
    [
        (0, []),
        (2, []),
        (5, ["0.5 m above the lowest wood of its tree, (31.00, -7.00, 2.00)"]),
        (30, ["1.8 m above the lowest wood", "touches no trunk"]),
    ],
)
def test_a_base_that_can_be_no_foot_is_doubted(node: int, says: list[str]) -> None:
    doubts = doubts_of_base(graph(), node)
    assert len(doubts) == len(says)
    assert all(words in doubt for words, doubt in zip(says, doubts, strict=True))


def test_without_categories_only_the_height_is_doubted() -> None:
    assert [len(doubts_of_base(graph(kinds=False), node)) for node in (0, 30)] == [0, 1]
