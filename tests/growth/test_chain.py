"""The chain that votes and grows, whole: clouds in, labelled trees out."""

import numpy as np
import pytest

from prunus import PrunusError, skeletonize
from prunus.errors import NoTreeError
from prunus.lab.simulate import simulate_scan
from prunus.model import Floats, Kind, Label, Skeleton
from prunus.model.branches import branches
from prunus.params import GROUPS, Parameters
from prunus.rules import offenders
from tests.conftest import simulated
from tests.growth.drawn import TEXTBOOK, surface_of


@pytest.fixture(scope="module")
def cloud() -> Floats:
    return surface_of(TEXTBOOK, np.random.default_rng(0))


def count(tree: Skeleton) -> list[int]:
    return [len(branches(tree, label)) for label in Label]


def test_a_textbook_tree_is_found_whole(cloud: Floats) -> None:
    result = skeletonize(cloud)
    assert count(result.skeleton)[:3] == [1, 2, 4]
    assert offenders(result.skeleton) == {}
    assert np.linalg.norm(result.skeleton.xyz[0]) < 0.05
    assert result.isolated is None


def test_the_same_cloud_gives_the_same_tree_bit_for_bit(cloud: Floats) -> None:
    here, there = (skeletonize(cloud).skeleton for _ in range(2))
    assert (here.xyz == there.xyz).all()
    assert (here.label == there.label).all()


def test_where_the_origin_lies_changes_nothing(cloud: Floats) -> None:
    shift = np.array([431_204.5, 5_120_330.25, 212.0])
    here, there = (skeletonize(xyz) for xyz in (cloud, cloud + shift))
    assert np.allclose(there.skeleton.xyz - shift, here.skeleton.xyz, atol=1e-3)


def test_of_two_trees_that_at_the_base_is_taken_and_the_other_left_out(cloud: Floats) -> None:
    row = np.concatenate([cloud, cloud + np.array([2.2, 0, 0])])
    for base in (0.0, 2.2):
        result = skeletonize(row, [base, 0, 0])
        assert result.isolated is not None
        kind = result.isolated.kind.reshape(2, -1)[int(base > 0)]
        assert (kind == Kind.TARGET).mean() > 0.97
        assert result.isolated.target.sum() < 1.03 * len(cloud)
        assert np.abs(result.skeleton.xyz[:, 0] - base).max() < 1.0


def test_points_that_were_not_drawn_go_with_the_wood_beside_them(cloud: Floats) -> None:
    row = np.concatenate([cloud, cloud + np.array([2.2, 0, 0])])
    params = Parameters.parse({"input": {"points": 6000}}, "test")
    result = skeletonize(row, [0, 0, 0], params)
    assert result.isolated is not None
    assert result.isolated.target[: len(cloud)].mean() > 0.99
    assert result.isolated.target[len(cloud) :].mean() < 0.01


def test_another_tree_could_be_meant_where_no_base_says_which(cloud: Floats) -> None:
    row = np.concatenate([cloud, cloud + np.array([2.2, 0, 0])])
    open_question, told = skeletonize(row), skeletonize(row, [0, 0, 0])
    assert any("another tree in view may be meant" in line for line in open_question.review)
    assert not any("may be meant" in line for line in told.review)


@pytest.mark.parametrize("seed", [3, 4])
def test_what_was_isolated_is_the_tree_of_one_step(seed: int) -> None:
    scan = simulate_scan(seed)
    one = skeletonize(scan.xyz)
    assert one.isolated is not None
    two = skeletonize(scan.xyz[one.isolated.target])
    assert two.isolated is None
    assert np.array_equal(one.skeleton.label, two.skeleton.label)
    # The origin lies elsewhere, so that a vote at the very limit of what is near may be of another.
    away = np.linalg.norm(one.skeleton.xyz - two.skeleton.xyz, axis=1)
    assert (away < 1e-3).mean() > 0.99 and away.max() < 0.01


def test_a_base_far_from_any_wood_is_refused(cloud: Floats) -> None:
    with pytest.raises(PrunusError, match="from the nearest wood"):
        skeletonize(cloud, [3, 3, 0])


def test_a_base_below_wood_that_weeds_hide_is_taken_with_a_note(cloud: Floats) -> None:
    above = cloud[cloud[:, 2] > 0.4]
    result = skeletonize(above, [0, 0, 0])
    assert any("below the lowest wood in view, which was taken" in note for note in result.notes)
    assert count(result.skeleton)[2] == 4


@pytest.mark.slow
def test_noise_is_no_tree() -> None:
    noise = np.random.default_rng(1).uniform(0, 1.5, (20_000, 3))
    with pytest.raises(NoTreeError):
        skeletonize(noise)


def test_trees_of_the_simulator_are_mostly_found() -> None:
    truth, cloud = simulated(4)
    found = skeletonize(cloud).skeleton
    distance = np.linalg.norm(truth.xyz[:, None] - found.xyz[None], axis=2).min(axis=1)
    thick = truth.edges_with(Label.SUPPORT) | truth.edges_with(Label.LEADER)
    assert (distance[thick] < 0.05).mean() > 0.8


@pytest.mark.slow
def test_each_parameter_that_is_shown_changes_some_result() -> None:
    """Of a row of two trees, one scanned much denser: points drawn, and what is the tree."""
    some = surface_of(TEXTBOOK, np.random.default_rng(0))
    near = np.random.default_rng(1).normal(0, 0.004, (60_000, 3)) + np.array([0, 0, 0.3])
    row = np.concatenate([some, some + np.array([2.2, 0, 0]), near])
    first = skeletonize(row, [0, 0, 0])
    shown = [
        (group, key)
        for group in GROUPS["default"]
        for key in getattr(Parameters(), group).model_dump()
    ]
    other = {
        ("input", "points"): 20_000,
        ("isolation", "isolate"): "never",
        ("isolation", "raw_from"): 0.95,
        ("growth", "gap_max"): 0.0,
        ("growth", "branch_min"): 0.6,
    }
    assert set(shown) == {*other, ("growth", "spur_min")}
    for (group, key), value in other.items():
        again = skeletonize(row, [0, 0, 0], Parameters().changed(group, **{key: value}))
        same = np.array_equal(again.skeleton.xyz, first.skeleton.xyz)
        whole = (again.isolated is None) == (first.isolated is None)
        assert not (same and whole), f"{group}.{key}"


def test_shorter_spurs_are_none_when_it_is_asked_for() -> None:
    cloud = simulated(4)[1]
    few = Parameters().changed("growth", spur_min=0.5)
    assert len(skeletonize(cloud, params=few).skeleton) < len(skeletonize(cloud).skeleton)
