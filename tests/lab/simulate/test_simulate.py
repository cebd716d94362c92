"""Simulated trees grow in the ranges asked for; scans know the truth of every point."""

from pathlib import Path

import numpy as np
import pytest

from prunus.lab.evaluate.curves import covered, sampled
from prunus.lab.simulate import Habits, grow_tree, simulate_scan, ufo_habits
from prunus.lab.simulate.orchard import write_simulated
from prunus.lab.simulate.scan_folder import read_scan
from prunus.lab.simulate.settings import habits_in, scan_settings
from prunus.model import Kind, Label
from prunus.model.branches import branches
from prunus.rules import junctions, label_linearity, label_progression, one_trunk_at_base
from tests.conftest import field_scan


def habits(**groups: dict[str, object]) -> Habits:
    """The shipped habits with some values replaced."""
    values = ufo_habits().model_dump()
    for group, changed in groups.items():
        values[group] |= changed
    return Habits.model_validate(values)


def grown(seed: int, asked: Habits | None = None, lean: float = 0.0, **form: object):
    return grow_tree(np.random.default_rng(seed), asked, lean, **form)


@pytest.mark.parametrize("seed", range(8))
def test_a_grown_tree_has_the_form_and_the_sizes_asked_for(seed: int) -> None:
    tree = grown(seed)
    for rule in (label_progression, one_trunk_at_base):  # real trees fork and shoot everywhere
        assert not rule(*junctions(tree)).any(), rule.__name__
    (trunk,) = branches(tree, Label.TRUNK)
    low, high = ufo_habits().trunk.height
    assert low - 1e-9 <= trunk.length <= high + 1e-9
    supports = branches(tree, Label.SUPPORT)
    assert len(supports) in (1, 2)
    assert sum(arm.length for arm in supports) >= 0.7
    assert 3 <= len(branches(tree, Label.LEADER)) <= 20
    assert tree.xyz[tree.edges_with(Label.LEADER), 2].max() < 3.3
    assert np.isfinite(tree.radius).all() and tree.radius.min() > 0.001
    assert tree.lengths.max() <= 0.02 + 1e-9


def test_wood_grows_thinner_from_label_to_label() -> None:
    tree = grown(3)
    mean = [tree.radius[tree.edges_with(label)].mean() for label in Label]
    assert mean == sorted(mean, reverse=True)


def test_supports_grow_where_they_are_asked_to_and_fill_the_room() -> None:
    tree = grown(1, sides=(-1.0,), room=0.9)
    (arm,) = branches(tree, Label.SUPPORT)
    assert arm.length <= 0.9 + 1e-9
    top = tree.xyz[arm.rows[0]]
    assert tree.xyz[arm.rows[-1], 0] < top[0] - 0.5


def test_a_leaning_plane_takes_the_leaders_along() -> None:
    lean = np.radians(25)
    tree = grown(2, lean=lean)
    leaders = tree.xyz[tree.edges_with(Label.LEADER)]
    slope = np.polyfit(leaders[:, 2], leaders[:, 1], 1)[0]
    assert 0.5 * np.tan(lean) < slope < 1.3 * np.tan(lean)


def level_share(asked: Habits) -> float:
    """Share of the leaders' length that runs level, over some trees."""
    trees = [grown(seed, asked) for seed in range(6)]
    rise = [t.edge_vectors[t.edges_with(Label.LEADER), 2] for t in trees]
    return float((np.abs(np.concatenate(rise)) < 0.01).mean())


def test_leaders_that_run_sideways_have_longer_level_stretches() -> None:
    never = level_share(habits(leader={"runs": 0.0}))
    always = level_share(habits(leader={"runs": 1.0}))
    assert always > 2 * never


def test_double_leaders_and_tall_shoots_come_at_the_rates_asked_for() -> None:
    plain = {"doubles": 0.0}
    alone = grown(4, habits(leader=plain))
    forked = grown(4, habits(leader={"doubles": 1.0}))

    def forks(tree) -> int:
        return int(label_linearity(*junctions(tree)).sum())

    few = habits(leader=plain, side_branch={"forks": 0.0})
    assert forks(grown(4, few)) == 0
    assert forks(forked) > forks(alone)
    shoots = habits(shoot={"on_support": (6, 6), "tall": 1.0}, leader=plain)
    tree = grown(4, shoots)
    top = tree.xyz[tree.edges_with(Label.LEADER), 2].max()
    thin = [b for b in branches(tree, Label.SIDE_BRANCH) if tree.label[b.rows[0]] == Label.SUPPORT]
    assert max(tree.xyz[b.rows[-1], 2] for b in thin) > 0.7 * top


def test_a_scan_is_a_function_of_its_seed() -> None:
    again, other = simulate_scan(11), simulate_scan(12)
    first = field_scan(11)
    assert np.array_equal(first.xyz, again.xyz)
    assert np.array_equal(first.kind, again.kind)
    assert first.xyz.shape != other.xyz.shape


@pytest.mark.parametrize("seed", [11, 13])
def test_points_lie_near_the_wood_that_they_are_said_to_belong_to(seed: int) -> None:
    scan = field_scan(seed)
    for number, tree in enumerate(scan.row.trees):
        own = scan.tree == number
        if own.any():
            away = np.linalg.norm(scan.xyz[own] - tree.xyz[scan.node[own]], axis=1)
            assert np.quantile(away - tree.radius[scan.node[own]], 0.9) < 0.06
    assert (scan.kind[scan.tree == 0] == Kind.TARGET).all()
    assert np.isin(Kind.GROUND, scan.kind) and np.isin(Kind.BEHIND, scan.kind)


def test_a_field_scan_is_seen_from_one_side_and_has_strays_and_gaps() -> None:
    scan = field_scan(11)
    curve, labels = sampled(scan.truth)
    target = scan.xyz[scan.kind == Kind.TARGET]
    seen = [covered(curve[labels == label], target) for label in Label]
    assert min(seen[Label.TRUNK], seen[Label.SUPPORT]) > 0.95
    assert 0.5 < seen[Label.LEADER] < 0.95 and 0.3 < seen[Label.SIDE_BRANCH] < 0.95
    assert 0 < (scan.kind == Kind.STRAY).mean() < 0.02


def test_a_clean_scan_holds_the_target_alone_close_to_its_surface() -> None:
    scan = simulate_scan(3, "clean")
    assert set(np.unique(scan.kind)) == {Kind.TARGET}
    tree = scan.row.trees[0]
    away = np.linalg.norm(scan.xyz - tree.xyz[scan.node], axis=1)
    assert np.quantile(away - tree.radius[scan.node], 0.95) < 0.016


@pytest.mark.parametrize("seed", range(6))
def test_an_ordinary_tree_is_as_the_paper_describes_it(seed: int) -> None:
    tree = grown(seed, habits_in("ordinary"))
    leaders, supports = branches(tree, Label.LEADER), branches(tree, Label.SUPPORT)
    assert 5 <= len(leaders) <= 12 and len(supports) in (1, 2)
    assert not label_linearity(*junctions(tree)).any()
    for arm in supports:
        rise = np.ptp(tree.xyz[arm.rows[[len(arm.rows) // 3, -1]], 2])
        assert rise < 0.45 * arm.length
    for leader in leaders:
        foot, top = tree.xyz[leader.rows[0]], tree.xyz[leader.rows[-1]]
        assert top[2] - foot[2] > 0.8 * np.linalg.norm(top - foot)
    thin = [b for b in branches(tree, Label.SIDE_BRANCH) if tree.label[b.rows[0]] == Label.LEADER]
    assert max(b.length for b in thin) < 0.4


def test_ordinary_trees_are_scanned_in_a_row_with_all_its_faults() -> None:
    scan = simulate_scan(11, "ordinary")
    assert {Kind.TARGET, Kind.BEHIND, Kind.GROUND, Kind.WIRE} <= set(np.unique(scan.kind))
    assert scan.truth.xyz[0, 2] > 0.01  # the lowest wood is hidden, as in the real scan


def test_only_what_is_said_of_the_ordinary_differs_from_the_hard() -> None:
    hard, ordinary = scan_settings("hard"), scan_settings("ordinary")
    assert (ordinary.rig, ordinary.stereo) == (hard.rig, hard.stereo)
    assert habits_in("clean") == habits_in("hard") == ufo_habits()
    assert habits_in("ordinary").spur == ufo_habits().spur
    assert habits_in("ordinary").leader.crosses == 0 < ufo_habits().leader.crosses


def test_field_is_another_name_of_hard() -> None:
    assert scan_settings("field") == scan_settings("hard")
    assert habits_in("field") == habits_in("hard")


def test_depth_images_give_the_cloud_back() -> None:
    scan = field_scan(11)
    assert len(scan.views) == 6
    view = scan.views[1]
    row, column = (values[0] for values in np.nonzero(view.depth))
    height, width = view.depth.shape
    z = view.depth[row, column]
    ray = [(column + 0.5 - width / 2) / scan.focal, (row + 0.5 - height / 2) / scan.focal, 1.0]
    point = view.nominal.apply(np.array(ray) * z)
    assert np.linalg.norm(scan.xyz - point, axis=1).min() < 0.01


def test_reading_what_was_written_gives_it_back(tmp_path: Path) -> None:
    scan = field_scan(11)
    write_simulated(tmp_path / "tree", scan, views=True)
    back = read_scan(tmp_path / "tree")
    assert np.allclose(back.xyz, scan.xyz, atol=1e-6)
    assert np.array_equal(back.kind, scan.kind)
    for ours, theirs in zip(back.trees, scan.row.trees, strict=True):
        assert np.array_equal(ours.xyz, theirs.xyz) and np.array_equal(ours.label, theirs.label)
    depth = np.load(tmp_path / "tree" / "view_0.npy")
    assert np.allclose(depth * 1e-3, scan.views[0].depth, atol=6e-4)
    write_simulated(tmp_path / "tree", scan)
    assert not (tmp_path / "tree" / "rig.json").exists()  # which was of the older scan
