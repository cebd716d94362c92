"""Limbs of drawn trees, with numbers worked out by hand."""

import numpy as np
import pytest

from prunus.cuts.limbs import Limb, Limbs
from prunus.model import Label, Skeleton
from tests.cuts.trees import drawn


def limb(limbs: Limbs, name: str) -> Limb:
    return next(one for one in limbs.all if one.name == name)


def test_limbs_know_their_names_their_parents_and_their_bark() -> None:
    limbs = Limbs.of(drawn())
    long = limb(limbs, "side branch 1")
    assert limbs.parent_of(long) is limb(limbs, "leader 1")
    assert limbs.parent_of(limb(limbs, "the trunk")) is None
    assert long.along[-1] == pytest.approx(0.3)
    assert long.bark == pytest.approx(0.010), "the radius of the leader: it leaves squarely"
    assert long.reach == pytest.approx(0.29)
    assert limb(limbs, "leader 1").bark == pytest.approx(0.020)


def test_a_radius_that_is_unknown_is_taken_for_a_likely_one() -> None:
    skeleton = drawn()
    limbs = Limbs.of(skeleton.with_radius(np.full(len(skeleton), np.nan)))
    assert limb(limbs, "side branch 1").bark == pytest.approx(0.010), "as thick as usual"


def test_a_branch_that_slants_leaves_the_bark_later() -> None:
    way = np.array([np.sin(np.radians(30)), 0, np.cos(np.radians(30))])
    foot = np.array([0, 0, 0.3])
    xyz = [[0, 0, 0], [0, 0, 0.1], *([0, 0, z] for z in (0.3, 0.6)), foot + 0.2 * way]
    labels = [Label.TRUNK, Label.TRUNK, Label.LEADER, Label.LEADER, Label.SIDE_BRANCH]
    skeleton = Skeleton.build(xyz, [-1, 0, 1, 2, 2], labels, radius=[0.01] * 5)
    found = limb(Limbs.of(skeleton), "side branch 1")
    assert found.bark == pytest.approx(0.020), "10 mm over the sine of 30 degrees"


def test_the_reach_of_a_branch_counts_its_forks() -> None:
    limbs = Limbs.of(drawn("l\nl  b\nlbbb\nl  \nst \n t \n o "))
    assert limb(limbs, "side branch 1").reach == pytest.approx(0.39)


def test_places_headings_and_values_along_a_limb() -> None:
    limbs = Limbs.of(drawn())
    long = limb(limbs, "side branch 1")
    assert long.at(0.15) == pytest.approx([0.15, 0, 0.5])
    assert long.heading(0.15) == pytest.approx([1, 0, 0])
    radius = limbs.skeleton.radius
    assert long.value_at(0.05, radius) == pytest.approx(0.005), "not mixed with the leader's"


def test_what_hangs_on_a_limb_comes_down_with_it() -> None:
    limbs = Limbs.of(drawn())
    leader, shoot = limb(limbs, "leader 1"), limb(limbs, "side branch 1")
    gone = limbs.beyond(leader, 0.25)
    assert gone[shoot.rows[1:]].all(), "it leaves at 0.3 m"
    assert gone[leader.rows].tolist() == [False, False, False, True, True]
    assert not limbs.beyond(leader, 0.35)[shoot.rows].any()
