"""What each rule asks for on drawn trees, and why it leaves the rest."""

import numpy as np
import pytest

from prunus.cuts import CutRules
from prunus.cuts.limbs import Limbs
from prunus.cuts.rules import Demand, Left, verdicts
from prunus.model import Label, Skeleton
from tests.cuts.trees import drawn


def said(
    skeleton: Skeleton, measured: bool = False, **groups: dict[str, object]
) -> dict[tuple[str, str], Demand | Left]:
    """What the rules say, by rule and branch."""
    limbs = Limbs.of(skeleton, measured=measured)
    found = verdicts(limbs, CutRules.parse(groups, "test"))
    return {
        (one.rule, one.limb.name if isinstance(one, Demand) else one.branch): one for one in found
    }


def why(one: Demand | Left) -> str:
    assert isinstance(one, Left), one
    return one.why


def thinned(skeleton: Skeleton, name: str, radius: float) -> Skeleton:
    """The skeleton with one branch of another radius."""
    rows = next(one for one in Limbs.of(skeleton).all if one.name == name).rows[1:]
    radii = skeleton.radius.copy()
    radii[rows] = radius
    return skeleton.with_radius(radii)


def test_long_side_branches_go_down_to_a_stub_and_short_ones_stay() -> None:
    found = said(drawn())
    long, short = found["side_branches", "side branch 1"], found["side_branches", "side branch 2"]
    assert isinstance(long, Demand)
    assert long.along == pytest.approx(0.03), "10 mm of bark and a stub of 20 mm"
    assert long.because == "0.29 m long, over 0.15 m"
    assert why(short) == "0.09 m long, not over 0.15 m"


def test_a_branch_just_over_the_limit_is_doubtful() -> None:
    found = said(drawn(), side_branches={"longer_than": 0.28})
    long = found["side_branches", "side branch 1"]
    assert isinstance(long, Demand) and long.doubts == ("only 0.01 m over the limit",)


def test_a_branch_just_under_the_limit_goes_for_review_where_a_scan_may_hide_its_tip() -> None:
    limit = {"longer_than": 0.30}
    branch = "side_branches", "side branch 1"
    seen = said(drawn(), measured=True, side_branches=limit)[branch]
    assert isinstance(seen, Demand) and seen.because == "0.29 m of it seen, limit 0.3 m"
    assert seen.doubts == ("0.01 m under the limit: its tip may be hidden",)
    assert why(said(drawn(), side_branches=limit)[branch]) == "0.29 m long, not over 0.3 m"
    far = said(drawn(), measured=True, side_branches={"longer_than": 0.34})[branch]
    assert why(far) == "0.29 m long, not over 0.34 m"


def test_leaders_far_apart_and_low_ones_stay() -> None:
    found = said(drawn())
    assert why(found["spacing", "leader 1"]) == (
        "0.50 m from leader 2 at mid height, not under 0.08 m"
    )
    assert why(found["height", "leader 2"]) == "0.40 m over the support, not over 2.4 m"


def test_of_two_leaders_too_close_the_thinner_goes_and_takes_its_branches_along() -> None:
    found = said(thinned(drawn(), "leader 1", 0.006), spacing={"closest": 0.6, "stub": 0.01})
    goes = found["spacing", "leader 1"]
    assert isinstance(goes, Demand)
    assert goes.along == pytest.approx(0.03), "20 mm of bark and a stub of 10 mm"
    assert goes.because.endswith("under 0.6 m; leader 1 is the thinner") and goes.doubts == ()
    assert why(found["spacing", "leader 2"]) == "leader 1, too close to it, goes"
    assert why(found["height", "leader 1"]) == "comes down by another rule"
    assert why(found["side_branches", "side branch 1"]) == "comes down by another rule"


def test_of_two_alike_the_less_sure_goes_then_the_shorter_and_both_are_doubtful() -> None:
    skeleton = drawn()
    sure = np.where(skeleton.xyz[:, 0] > 0.45, 0.8, 1.0)
    doubted = Skeleton.build(
        skeleton.xyz, skeleton.parent, skeleton.label, radius=skeleton.radius, confidence=sure
    )
    goes = said(doubted, spacing={"closest": 0.6})["spacing", "leader 2"]
    assert isinstance(goes, Demand) and goes.doubts == ("leader 2 is the less sure of two alike",)
    short = drawn("l\nl    l\nlbbb lb\nl    l\nl    l\nssstss\n   t\n   o")
    goes = said(short, spacing={"closest": 0.6})["spacing", "leader 2"]
    assert isinstance(goes, Demand) and goes.doubts == ("leader 2 is the shorter of two alike",)


def test_where_it_is_not_plain_which_leader_goes_the_branches_of_both_are_planned() -> None:
    close = {"closest": 0.6}
    branch = "side_branches", "side branch 1"
    picture = drawn("     l\nl    l\nlbbb lb\nl    l\nl    l\nssstss\n   t\n   o")
    kept = said(picture, measured=True, spacing=close)[branch]
    assert isinstance(kept, Demand)
    assert kept.doubts == ("only if leader 1 stays, which is not plain",)
    assert why(said(picture, spacing=close)[branch]) == "comes down by another rule"
    thin = thinned(picture, "leader 1", 0.006)
    plain = said(thin, measured=True, spacing=close)[branch]
    assert why(plain) == "comes down by another rule"


def test_leaders_without_height_in_common_are_not_compared() -> None:
    found = said(drawn("l    \nl    \nl  l \nsstss\n  t\n  o"), spacing={"closest": 2.0})
    assert why(found["spacing", "leader 1"]) == "no other leader stands beside it"


def test_of_three_in_a_bundle_the_closest_pair_is_thinned_first() -> None:
    skeleton = thinned(
        drawn("l  l l\nl  l l\nl  l l\nl  l l\nssstss\n   t\n   o"), "leader 2", 0.006
    )
    found = said(skeleton, spacing={"closest": 0.35})
    assert isinstance(found["spacing", "leader 2"], Demand)
    assert why(found["spacing", "leader 1"]) == "leader 2, too close to it, goes"
    assert why(found["spacing", "leader 3"]) == "leader 2, too close to it, goes"


def test_tall_leaders_are_shortened_and_what_is_above_goes_with_the_top() -> None:
    found = said(drawn(), height={"over": 0.3, "to": 0.25})
    cut = found["height", "leader 1"]
    assert isinstance(cut, Demand)
    assert cut.along == pytest.approx(0.25) and np.isnan(cut.stub)
    assert why(found["side_branches", "side branch 1"]) == "comes down by another rule"


def test_side_branches_of_anything_but_leaders_stay() -> None:
    skeleton = drawn()
    label = skeleton.label.copy()
    label[label == Label.LEADER] = Label.SUPPORT
    relabelled = Skeleton.build(skeleton.xyz, skeleton.parent, label, radius=skeleton.radius)
    found = said(relabelled)
    assert why(found["side_branches", "side branch 1"]).endswith(", not a leader")


def test_a_fork_of_a_side_branch_goes_with_it_or_stays_with_it() -> None:
    found = said(drawn("l\nl  b\nlbbb\nl  \nst \n t \n o "))
    assert isinstance(found["side_branches", "side branch 1"], Demand)


def test_a_rule_that_is_switched_off_says_so() -> None:
    found = said(drawn(), side_branches={"apply": False})
    assert why(found["side_branches", "every branch"]) == "the rule is switched off"
    assert not any(isinstance(one, Demand) for one in found.values())


def test_the_base_alone_asks_for_nothing() -> None:
    assert said(Skeleton.build([[0, 0, 0]], [-1], [0])) == {}
