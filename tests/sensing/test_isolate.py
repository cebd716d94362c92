"""One tree out of a raw scan of a simulated row whose every point is known."""

from dataclasses import replace

import numpy as np
import pytest

from prunus.errors import PrunusError
from prunus.model import Floats, Kind, PointCloud
from prunus.params import Parameters
from prunus.pipeline import skeletonize
from prunus.sensing.isolate import Scene, check_at, isolate, look_at
from prunus.sensing.surroundings import LINKS, surest
from prunus.sensing.trunks import foot_of
from prunus.simulate.scan import Scan, simulate_scan

SEED = 500_000


@pytest.fixture(scope="module")
def row() -> Scan:
    return simulate_scan(SEED)


@pytest.fixture(scope="module")
def scene(row: Scan) -> Scene:
    return look_at(PointCloud.from_xyz(row.xyz), Parameters(), np.random.default_rng(0))


def test_the_target_is_kept_and_all_else_taken_out(row: Scan, scene: Scene) -> None:
    found = isolate(scene, None)
    target = row.kind == Kind.TARGET
    assert found.target[target].mean() > 0.95
    assert (~found.target[~target]).mean() > 0.95
    for kind in (Kind.GROUND, Kind.BEHIND):
        assert (found.kind[row.kind == kind] == kind).mean() > 0.9
    assert found.removed == pytest.approx((row.kind != Kind.TARGET).mean(), abs=0.05)


def test_the_foot_is_the_lowest_of_the_trunk_that_the_scan_holds(row: Scan, scene: Scene) -> None:
    found = isolate(scene, None)
    foot = scene.cloud.to_input.apply(found.foot)
    assert np.linalg.norm(foot - row.truth.xyz[0]) < 0.03


def test_a_point_chooses_the_tree_and_no_point_is_in_two(row: Scan, scene: Scene) -> None:
    assert len(scene.trees) > 1
    assert np.sum([tree.target for tree in scene.trees], axis=0).max() == 1
    other = scene.trees[1]
    chosen = isolate(scene, other.foot)
    assert chosen.target[other.target].mean() > 0.95
    assert chosen.target[scene.trees[0].target].mean() < 0.5


def test_a_tree_that_could_be_meant_as_well_is_named(
    scene: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert isolate(scene, None).rival is None, "the others stand well aside"
    monkeypatch.setattr("prunus.sensing.isolate.CLOSE", 10.0)
    rival = isolate(scene, None).rival
    assert rival is not None
    assert np.array_equal(rival, scene.trees[1].foot)
    assert isolate(scene, scene.trees[1].foot).rival is None, "a point says which is meant"


def test_a_point_far_from_everything_is_refused(scene: Scene) -> None:
    with pytest.raises(PrunusError, match=r"m from the nearest part of the scan"):
        check_at(scene, np.array([9.0, 0, 0]))


def test_one_clean_tree_loses_next_to_nothing(row: Scan) -> None:
    cloud = PointCloud.from_xyz(row.xyz[row.kind == Kind.TARGET])
    found = isolate(look_at(cloud, Parameters(), np.random.default_rng(0)), None)
    assert found.removed <= 0.005


def test_skeletonize_isolates_raw_scans_alone(row: Scan) -> None:
    raw = skeletonize(row.xyz)
    assert raw.isolated is not None
    assert any("a raw scan" in note for note in raw.notes)
    clean = skeletonize(row.xyz[row.kind == Kind.TARGET])
    assert clean.isolated is None
    assert len(clean.scan) == (row.kind == Kind.TARGET).sum()
    kept = skeletonize(
        row.xyz, row.truth.xyz[0], Parameters().changed("isolation", isolate="never")
    )
    assert kept.isolated is None


def test_without_a_base_the_skeleton_stands_at_the_foot(row: Scan) -> None:
    found = skeletonize(row.xyz)
    assert np.linalg.norm(found.skeleton.xyz[0] - row.truth.xyz[0]) < 0.05
    assert any("foot of the trunk was found" in note for note in found.notes)


def test_a_mirrored_scan_is_seen_mirrored(scene: Scene) -> None:
    pieces, base = scene.pieces, scene.trees[0].foot
    one = pieces.seen_from(base)
    seen = pieces.turned(np.diag([-1.0, 1, 1])).seen_from(base * [-1, 1, 1])
    beside = pieces.shape.shape[1] + pieces.along.shape[1]
    assert seen.node[:, beside] == pytest.approx(-one.node[:, beside], abs=1e-6)
    assert seen.node[:, beside + 1 :] == pytest.approx(one.node[:, beside + 1 :], abs=1e-5)
    assert seen.link[:, :, 3] == pytest.approx(one.link[:, :, 3], abs=1e-5)


def test_the_surest_edges_come_first() -> None:
    edges = np.array([[0, k] for k in range(1, LINKS + 3)])
    confidence = np.linspace(0, 1, len(edges))
    linked = surest(edges, confidence, len(edges) + 1)
    assert linked[0].tolist() == list(range(len(edges) - 1, 1, -1))
    assert linked[1].tolist() == [0] + [-1] * (LINKS - 1)


def test_the_foot_of_a_round_post_seen_from_the_front(rng: np.random.Generator) -> None:
    angle, height = rng.uniform(np.pi, 2 * np.pi, 4000), rng.uniform(0.1, 0.8, 4000)
    front: Floats = np.column_stack([0.04 * np.cos(angle), 0.04 * np.sin(angle), height])
    assert np.linalg.norm(foot_of(front, np.array([0.02, -0.03, 0.15])) - [0, 0, 0.1]) < 0.02


def test_the_trunk_of_a_tree_is_found(scene: Scene, row: Scan) -> None:
    bases = scene.cloud.to_input.apply(np.array([trunk.base for trunk in scene.trunks]))
    assert np.linalg.norm(bases - row.truth.xyz[0], axis=1).min() < 0.15


def test_wood_that_hangs_on_the_tree_and_was_left_out_is_said(row: Scan) -> None:
    cloud = PointCloud.from_xyz(row.xyz[row.kind == Kind.TARGET])
    scene = look_at(cloud, Parameters(), np.random.default_rng(0))
    whole = isolate(scene, None)
    assert scene.torn(whole) < 0.1
    beside = cloud.xyz[:, 0] > np.quantile(cloud.xyz[:, 0], 0.35)
    half = replace(whole, kind=np.where(beside, Kind.NEIGHBOUR, whole.kind))
    assert scene.torn(half) > 0.4
    assert "--no-isolate" in replace(half, torn=scene.torn(half)).doubts()[0]
    assert replace(whole, torn=scene.torn(whole)).doubts() == []


def test_trees_look_like_branches_and_the_ground_does_not(row: Scan, scene: Scene) -> None:
    found = isolate(scene, None)
    assert scene.linearity(found) > 0.5
    ground = replace(found, kind=np.where(found.kind == Kind.GROUND, Kind.TARGET, Kind.STRAY))
    assert scene.linearity(ground) < 0.45


def test_a_point_below_a_trunk_means_it_though_weeds_hide_its_foot(scene: Scene) -> None:
    base = scene.trees[0].base
    below = isolate(scene, base - [0.0, 0.0, 0.45])
    assert np.array_equal(below.base, base)
