"""Laws of the whole chain, over simulated trees and seeds."""

from functools import cache

import numpy as np
import pytest

from prunus.model import PointCloud, Skeleton
from prunus.params import Parameters
from prunus.pipeline import skeletonize
from prunus.result import Result
from prunus.rules import offenders
from prunus.search import learned_score_of, shipped_score, skel_score
from tests.conftest import simulated

SMALL = Parameters().changed("search", K=60)
SEEDS = [0, 1, 2, 3]


@cache
def result(seed: int) -> Result:
    truth, cloud = simulated(seed)
    return skeletonize(cloud, truth.xyz[0], SMALL, seed)


def same_decisions(first: Skeleton, second: Skeleton) -> bool:
    return all(
        np.array_equal(getattr(first, name), getattr(second, name), equal_nan=True)
        for name in ("parent", "label", "confidence", "superpoint")
    )


@pytest.mark.parametrize("seed", SEEDS)
def test_every_result_is_a_legal_tree_rooted_at_the_base(seed: int) -> None:
    found = result(seed)
    assert offenders(found.skeleton) == {}
    assert found.skeleton.superpoint[0] == found.graph.base
    assert len(np.unique(found.skeleton.superpoint)) == len(found.skeleton)


@pytest.mark.parametrize("seed", SEEDS)
def test_every_edge_is_a_candidate_with_its_confidence(seed: int) -> None:
    found = result(seed)
    known = {
        (int(i), int(j)): c
        for (i, j), c in zip(found.graph.edges, found.graph.confidence, strict=True)
    }
    nodes = found.skeleton.superpoint
    for (above, below), c in zip(found.skeleton.edges, found.skeleton.confidence[1:], strict=True):
        i, j = sorted((int(nodes[above]), int(nodes[below])))
        assert known[i, j] == c


@pytest.mark.parametrize("seed", SEEDS)
def test_the_score_is_the_sum_of_its_terms(seed: int) -> None:
    found = result(seed)
    told = learned_score_of(found.in_house, found.graph, shipped_score())
    assert found.score == pytest.approx(told, abs=1e-6)
    assert (np.diff(found.history) >= 0).all()


@pytest.mark.parametrize("seed", SEEDS)
def test_as_in_the_paper_the_score_is_the_sum_of_the_rewards(seed: int) -> None:
    truth, cloud = simulated(seed)
    params = Parameters.paper().changed("search", K=60)
    found = skeletonize(cloud, truth.xyz[0], params, seed)
    assert found.score == pytest.approx(skel_score(found.in_house, params))
    assert offenders(found.skeleton) == {}


@pytest.mark.parametrize("seed", SEEDS)
def test_the_same_seed_gives_the_same_skeleton_bit_for_bit(seed: int) -> None:
    truth, cloud = simulated(seed)
    again = skeletonize(cloud, truth.xyz[0], SMALL, seed)
    assert same_decisions(again.skeleton, result(seed).skeleton)
    assert np.array_equal(again.skeleton.xyz, result(seed).skeleton.xyz)
    assert np.array_equal(again.history, result(seed).history)


@pytest.mark.parametrize("seed", SEEDS)
def test_another_seed_gives_other_superpoints(seed: int) -> None:
    truth, cloud = simulated(seed)
    other = skeletonize(cloud, truth.xyz[0], SMALL, seed + 100)
    assert not np.array_equal(other.graph.xyz, result(seed).graph.xyz)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("shift", [(3.0, -7.25, 100.5), (612_345.0, 5_123_456.0, 321.0)])
def test_moving_the_cloud_moves_the_skeleton(seed: int, shift: tuple[float, ...]) -> None:
    truth, cloud = simulated(seed)
    points = cloud.to_input.apply(cloud.xyz)
    moved = skeletonize(points + np.array(shift), truth.xyz[0] + shift, SMALL, seed)
    still = skeletonize(points, truth.xyz[0], SMALL, seed)
    assert same_decisions(moved.skeleton, still.skeleton)
    assert moved.skeleton.xyz == pytest.approx(still.skeleton.xyz + shift, abs=1e-5, rel=0)


@pytest.mark.parametrize("seed", SEEDS)
def test_turning_the_cloud_half_round_turns_the_skeleton(seed: int) -> None:
    truth, cloud = simulated(seed)
    points = cloud.to_input.apply(cloud.xyz)
    half = np.array([-1.0, -1.0, 1.0])
    turned = skeletonize(points * half, truth.xyz[0] * half, SMALL, seed)
    still = skeletonize(points, truth.xyz[0], SMALL, seed)
    assert same_decisions(turned.skeleton, still.skeleton)
    assert turned.skeleton.xyz == pytest.approx(still.skeleton.xyz * half, abs=1e-9)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_named_frame_changes_nothing_but_coordinates(seed: int) -> None:
    truth, cloud = simulated(seed)
    to_optical = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
    points = cloud.to_input.apply(cloud.xyz)
    seen = PointCloud.from_xyz(points @ to_optical.T, "optical")
    found = skeletonize(seen, to_optical @ truth.xyz[0], SMALL, seed)
    still = skeletonize(points, truth.xyz[0], SMALL, seed)
    assert same_decisions(found.skeleton, still.skeleton)
    assert found.skeleton.xyz == pytest.approx(still.skeleton.xyz @ to_optical.T, abs=1e-9)
