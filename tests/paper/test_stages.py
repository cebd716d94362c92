"""Each stage on clouds whose answer is known by hand."""

import numpy as np
import pytest

from prunus.errors import PrunusError
from prunus.model import CandidateGraph, Floats, Label, PointCloud, ScoredGraph
from prunus.paper import superpoints
from prunus.paper.candidates import find_candidates
from prunus.paper.confidence import score_edges
from prunus.paper.images import edge_images
from prunus.paper.networks import NetworkScorer
from prunus.paper.seeds import find_seeds
from prunus.paper.superpoints import find_superpoints
from prunus.params import Parameters

PARAMS = Parameters.paper()


def rod(start: list[float], end: list[float], rng: np.random.Generator, count: int = 600) -> Floats:
    """Points along a stick, as thick as a leader looks in a scan."""
    share = rng.random((count, 1))
    points = np.array(start) * (1 - share) + np.array(end) * share
    return np.asarray(points + rng.normal(0, 0.015, (count, 3)))


def scored(points: Floats, rng: np.random.Generator) -> ScoredGraph:
    found = find_superpoints(PointCloud.from_xyz(points), PARAMS.superpoints, rng)
    return score_edges(find_candidates(found), NetworkScorer())


def test_superpoints_lie_in_the_wood_and_noise_gets_none(rng: np.random.Generator) -> None:
    stick = rod([0, 0, 0], [0, 0, 1], rng)
    cloud = PointCloud.from_xyz(np.concatenate([stick, [[3.0, 0, 0], [3.0, 0, 0.05]]]))
    found = find_superpoints(cloud, PARAMS.superpoints, rng)
    back = cloud.to_input.apply(found.xyz)
    assert np.abs(back[:, :2]).max() < 0.04
    assert 5 <= len(found) <= 14
    assert found.unused_points >= 2
    assert found.points_near(np.arange(len(found))).sum() == len(cloud) - found.unused_points


def test_a_cloud_too_thin_for_any_superpoint_is_refused(rng: np.random.Generator) -> None:
    cloud = PointCloud.from_xyz(np.arange(30.0).reshape(10, 3))
    with pytest.raises(PrunusError, match="nowhere do 8 of the 10 points drawn lie close"):
        find_superpoints(cloud, PARAMS.superpoints, rng)


def test_candidates_are_the_pairs_within_twice_the_radius(rng: np.random.Generator) -> None:
    cloud = PointCloud.from_xyz(rod([0, 0, 0], [0, 0, 1], rng))
    found = find_superpoints(cloud, PARAMS.superpoints, rng)
    edges = find_candidates(found).edges
    far = np.linalg.norm(found.xyz[:, None] - found.xyz, axis=2)
    expected = np.argwhere(np.triu(far <= 0.2, 1))
    assert edges.tolist() == expected.tolist()


def test_a_stick_scores_high_and_a_bridge_between_two_sticks_low(rng: np.random.Generator) -> None:
    first = rod([0, 0, 0], [0, 0, 1], rng)
    second = rod([0.17, 0, 0], [0.17, 0, 1], rng)
    graph = scored(np.concatenate([first, second]), rng)
    vector = graph.xyz[graph.edges[:, 1]] - graph.xyz[graph.edges[:, 0]]
    along = np.abs(vector[:, 2]) > 4 * np.abs(vector[:, 0])
    across = np.abs(vector[:, 0]) > 0.12
    assert graph.confidence[along].min() > 0.7
    assert graph.confidence[across].max(initial=0) < 0.2


def test_images_are_sixteen_by_thirty_two_and_at_most_one(rng: np.random.Generator) -> None:
    cloud = PointCloud.from_xyz(rod([0, 0, 0], [0, 0, 1], rng))
    candidates = find_candidates(find_superpoints(cloud, PARAMS.superpoints, rng))
    images = edge_images(candidates)
    assert images.shape == (len(candidates.edges), 16, 32)
    assert (images.max(axis=(1, 2)) == 1).all()


def test_tips_are_the_tops_of_upright_sticks(rng: np.random.Generator) -> None:
    sticks = [rod([x, 0, 0], [x, 0, 1 + x / 4], rng) for x in (0.0, 0.5, 1.0)]
    level = rod([0, 0, 0], [1, 0, 0], rng)
    graph = scored(np.concatenate([*sticks, level]), rng)
    seeded, _ = find_seeds(graph, PARAMS, graph.xyz[graph.xyz[:, 2].argmin()])
    tops = graph.candidates.superpoints.cloud.to_input.apply(seeded.xyz[seeded.tips])
    assert sorted(np.round(tops[:, 0] * 2) / 2) == [0.0, 0.5, 1.0]
    assert tops[:, 2] == pytest.approx(1 + tops[:, 0] / 4, abs=0.1)


def test_the_base_is_the_nearest_superpoint_or_refused(rng: np.random.Generator) -> None:
    graph = scored(rod([0, 0, 0], [0, 0, 1], rng), rng)
    foot = int(graph.xyz[:, 2].argmin())
    seeded, warnings = find_seeds(graph, PARAMS, graph.xyz[foot] + 0.01)
    assert (seeded.base, warnings) == (foot, [])
    with pytest.raises(PrunusError, match=r"the base \(9.*\) is .* m from the nearest part"):
        find_seeds(graph, PARAMS, np.array([9.0, 9.0, 9.0]))


def test_a_base_is_found_at_the_foot_and_said_so(rng: np.random.Generator) -> None:
    graph = scored(rod([0, 0, 0], [0, 0, 1], rng), rng)
    seeded, warnings = find_seeds(graph, PARAMS)
    assert seeded.base == graph.xyz[:, 2].argmin()
    assert "no base was given" in warnings[0]


def test_a_lying_stick_has_no_tips(rng: np.random.Generator) -> None:
    graph = scored(rod([0, 0, 0], [1, 0, 0], rng), rng)
    with pytest.raises(PrunusError, match="no tips of leaders were found"):
        find_seeds(graph, PARAMS)


def test_labels_come_in_the_order_of_growth() -> None:
    assert list(Label) == [Label.TRUNK, Label.SUPPORT, Label.LEADER, Label.SIDE_BRANCH]


def test_superpoints_in_one_place_get_no_edge() -> None:
    from prunus.model import Superpoints

    cloud = PointCloud.from_xyz(np.zeros((4, 3)))
    same = Superpoints(cloud, np.zeros((2, 3)), [0, 4, 8], [0, 1, 2, 3] * 2, 0.1)
    found = find_candidates(same)
    assert isinstance(found, CandidateGraph)
    assert len(found.edges) == 0


@pytest.mark.parametrize(
    ("most", "says"),
    [
        ("MOST_POINTS", "points of superpoints"),
        ("MOST_POINTS_OF_EDGES", "points of edges"),
        ("MOST_PAIRS", "pairs of edges"),
    ],
)
def test_superpoints_that_would_fill_the_memory_are_refused_before(
    most: str, says: str, rng: np.random.Generator, monkeypatch: pytest.MonkeyPatch
) -> None:
    cloud = PointCloud.from_xyz(rod([0, 0, 0], [0, 0, 2], rng, 3000))
    find_superpoints(cloud, PARAMS.superpoints, rng)
    monkeypatch.setattr(superpoints, most, 10.0)
    with pytest.raises(PrunusError, match=f"{says}; expected at most 1e.01: a smaller r_super"):
        find_superpoints(cloud, PARAMS.superpoints, rng)
