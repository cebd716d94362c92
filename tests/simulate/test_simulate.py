"""Simulated trees are legal, of a plausible size, and the same for the same seed."""

import numpy as np
import pytest

from prunus.measure import branches, leaders
from prunus.model import Label
from prunus.rules import offenders
from prunus.simulate import Faults, Habits, grow_tree, scan_tree


@pytest.mark.parametrize("seed", range(8))
def test_a_grown_tree_is_legal_with_the_ranges_asked_for(seed: int) -> None:
    tree = grow_tree(np.random.default_rng(seed))
    assert offenders(tree) == {}
    (trunk,) = branches(tree, Label.TRUNK)
    low, high = Habits().trunk_height
    assert low - 0.02 <= trunk.length <= high + 0.02
    assert len(branches(tree, Label.SUPPORT)) in (1, 2)
    assert all(0.8 < leader.height < 2.1 for leader in leaders(tree))
    assert np.isfinite(tree.radius).all() and tree.radius.min() > 0


def test_the_same_seed_grows_and_scans_the_same() -> None:
    clouds = []
    for _ in range(2):
        rng = np.random.default_rng(5)
        clouds.append(scan_tree(grow_tree(rng), rng, Faults(points=2000)).xyz)
    assert np.array_equal(*clouds)


def test_a_leader_looks_as_fat_as_in_a_real_scan() -> None:
    rng = np.random.default_rng(1)
    tree = grow_tree(rng, Habits(v_lean=(0, 0), kinks=(0, 0)))
    cloud = scan_tree(tree, rng)
    points = cloud.to_input.apply(cloud.xyz)
    widths = []
    for branch in branches(tree, Label.LEADER):
        middle = tree.xyz[branch.rows[len(branch.rows) // 2]]
        near = points[np.abs(points - middle).max(axis=1) < [0.1]]
        widths.append(np.ptp(np.quantile(near[:, 0], [0.05, 0.95])))
    assert 0.07 < np.median(widths) < 0.12


def test_one_support_where_two_are_never_wanted() -> None:
    tree = grow_tree(np.random.default_rng(0), Habits(two_supports=0))
    assert len(branches(tree, Label.SUPPORT)) == 1
