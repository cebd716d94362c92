"""What points say of a branch, on drawn ones."""

import numpy as np
import pytest

from prunus.cuts.limbs import Limb, Limbs
from prunus.cuts.nearby import AT_CUT_M, NO_LINE_M, Nearby, nearby, told_by_points
from prunus.model import Floats
from tests.cuts.trees import drawn

NONE = np.zeros((0, 3))
ALONG = 0.03
"""Of the cut of the drawn branch, whose foot is at (0, 0, 0.5) and which grows along X."""


@pytest.fixture
def limbs() -> Limbs:
    return Limbs.of(drawn())


@pytest.fixture
def branch(limbs: Limbs) -> Limb:
    return next(limb for limb in limbs.all if limb.name == "side branch 1")


def line(start: float, end: float, y: float, z: float) -> Floats:
    """A point a millimetre along X."""
    x = np.arange(start, end, 0.001)
    return np.column_stack([x, np.full(len(x), y), np.full(len(x), z)])


def test_points_near_each_cut_and_tip() -> None:
    scan = np.array([[0.0, 0.0, 0.0], [0.29, 0.0, 0.0], [0.31, 0.0, 0.0], [1.0, 0.0, 0.0]])
    cuts, tips = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]), np.array([[0.3, 0.0, 0.0]] * 2)
    found = nearby(scan, cuts, tips)
    assert [len(one.cut) for one in found] == [2, 1]
    assert [len(one.tip) for one in found] == [2, 2]
    assert nearby(scan, NONE, NONE) == []


def test_points_beside_the_axis_are_spread_and_aside(limbs: Limbs, branch: Limb) -> None:
    scan = line(0.0, 0.3, -0.004, 0.5)
    told = told_by_points(limbs, branch, 0.01, ALONG, Nearby(scan, NONE))
    assert told["spread"] == pytest.approx(0.004)
    assert told["aside"] == pytest.approx(0.004)
    assert told["behind"] == 0 and told["past"] == 0


def test_no_points_at_the_cut_tell_no_line(limbs: Limbs, branch: Limb) -> None:
    told = told_by_points(limbs, branch, 0.01, ALONG, Nearby(NONE, NONE))
    assert told["spread"] == AT_CUT_M and told["aside"] == NO_LINE_M


def test_the_wood_of_the_leader_does_not_count(limbs: Limbs, branch: Limb) -> None:
    heights = np.arange(0.3, 0.6, 0.001)
    leader = np.column_stack([np.full(300, 0.005), np.full(300, -0.012), heights])
    told = told_by_points(limbs, branch, 0.01, ALONG, Nearby(leader, NONE))
    assert told["aside"] == NO_LINE_M


def test_a_branch_that_comes_from_behind_its_leader_has_wood_there(
    limbs: Limbs, branch: Limb
) -> None:
    through = line(-0.3, 0.3, 0.0, 0.5)
    told = told_by_points(limbs, branch, 0.01, ALONG, Nearby(through, NONE))
    assert told["behind"] == 1


def test_wood_ahead_of_the_tip_is_counted_in_cubes(limbs: Limbs, branch: Limb) -> None:
    on = line(0.32, 0.38, 0.0, 0.5)
    beside = line(0.27, 0.31, 0.05, 0.5)
    told = told_by_points(limbs, branch, 0.01, ALONG, Nearby(NONE, np.concatenate([on, beside])))
    assert told["past"] in (5, 6), "from 25 mm past the tip to 80 mm"


def test_nothing_is_told_of_a_limb_without_a_parent(limbs: Limbs) -> None:
    trunk = next(limb for limb in limbs.all if limb.name == "the trunk")
    assert told_by_points(limbs, trunk, 0.01, 0.1, Nearby(NONE, NONE)) == {}
