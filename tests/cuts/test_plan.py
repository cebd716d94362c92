"""Plans: hand-worked on the drawn tree, then the laws on simulated ones."""

import math
from dataclasses import replace

import numpy as np
import pytest

from prunus.cuts import CutRules, Plan, plan_cuts, shipped_rules
from prunus.cuts.limbs import Limbs
from prunus.cuts.plan import as_it_is
from prunus.model import Floats, Label, RigidMotion, Skeleton
from prunus.pipeline import skeletonize
from prunus.result import Result
from tests.conftest import simulated
from tests.cuts.trees import drawn

SURE = 0.99
FAR = np.array([[5.0, 5.0, 5.0]])
EVERYTHING = CutRules.parse(
    {"spacing": {"closest": 0.3}, "height": {"over": 1.0, "to": 0.8}}, "test"
)


def tubes(skeleton: Skeleton) -> Floats:
    """Points on the front of the drawn wood, a few millimetres apart."""
    rng = np.random.default_rng(0)
    edge = rng.choice(np.arange(1, len(skeleton)), 20_000)
    share = rng.random((len(edge), 1))
    start, end = skeleton.xyz[skeleton.parent[edge]], skeleton.xyz[edge]
    across = rng.uniform(-1, 1, (len(edge), 3))
    across[:, 1] = -np.abs(across[:, 1])
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    return np.asarray(start + share * (end - start) + skeleton.radius[edge, None] * across)


@pytest.fixture(scope="module")
def found() -> Result:
    truth, cloud = simulated(4)
    return skeletonize(cloud, truth.xyz[0])


@pytest.fixture(scope="module")
def plan(found: Result) -> Plan:
    return plan_cuts(found.refined, found.scan.xyz, EVERYTHING)


def test_the_cut_of_the_drawn_branch() -> None:
    skeleton = drawn()
    (cut,) = plan_cuts(skeleton, tubes(skeleton), likely=vouched(skeleton)).cuts
    assert cut.id == "side_branches:side-branch-1" and cut.branch == "side branch 1"
    assert cut.point == pytest.approx((0.03, 0.0, 0.5))
    assert cut.branch_direction == pytest.approx((1, 0, 0))
    assert (cut.diameter, cut.diameter_error, cut.stub) == pytest.approx((0.01, 0.0, 0.02))
    assert cut.removed_length == pytest.approx(0.27)
    assert cut.removed_volume == pytest.approx(math.pi * 0.005**2 * 0.27)
    assert cut.approach is not None and cut.approach.half_angle > 10
    assert not cut.needs_review, cut.reasons


def test_without_a_cloud_every_cut_is_for_a_person() -> None:
    (cut,) = plan_cuts(drawn()).cuts
    assert cut.approach is None and cut.needs_review
    assert cut.blade_normal == cut.branch_direction
    assert cut.reasons[-1] == "no cloud: what stands in the way is not known"


def test_of_which_nobody_knows_how_likely_it_is_no_cut_is_sure() -> None:
    skeleton = drawn()
    (cut,) = plan_cuts(skeleton, tubes(skeleton)).cuts
    assert cut.confidence == 0
    assert cut.reasons == ("how likely its branch is right is not known",)


def vouched(skeleton: Skeleton, label: Label | None = None, likely: float = SURE) -> Floats:
    """How likely the branch of each row is right: those of a label so, all others surely."""
    return np.where(skeleton.label == label, likely, SURE)


def reasons(
    skeleton: Skeleton,
    scan: Floats | None = None,
    likely: Floats | None = None,
    **groups: dict[str, object],
) -> str:
    scan = tubes(drawn()) if scan is None else scan
    likely = vouched(skeleton) if likely is None else likely
    cuts = plan_cuts(skeleton, scan, CutRules.parse(groups, "test"), likely=likely).cuts
    return "; ".join(reason for cut in cuts for reason in cut.reasons)


def test_what_is_doubtful_is_said() -> None:
    skeleton = drawn()
    unknown = skeleton.with_radius(np.full(len(skeleton), np.nan))
    assert "its diameter is not known" in reasons(unknown)
    assert "under 0.85" in reasons(skeleton, likely=vouched(skeleton, Label.SIDE_BRANCH, 0.02))
    for doubted in Label.LEADER, Label.SUPPORT:
        told = reasons(skeleton, likely=vouched(skeleton, doubted, 0.2))
        assert "a branch on the way to it is likely wrong (20% sure)" in told, doubted
    thick = skeleton.with_radius(np.where(skeleton.label == Label.SIDE_BRANCH, 0.009, 0.01))
    assert "90% as thick as its leader: it may be one" in reasons(thick)
    assert "18 mm thick: it may be a leader" in reasons(thick)
    assert "only 0.01 m over the limit" in reasons(skeleton, side_branches={"longer_than": 0.28})
    assert "it goes through a leader" in reasons(skeleton, height={"over": 0.3, "to": 0.25})


def test_what_stands_beside_the_blade_is_said() -> None:
    skeleton = drawn()
    wire = np.column_stack([np.full(200, 0.05), np.linspace(-1, 1, 200), np.full(200, 0.535)])
    scan = np.concatenate([tubes(skeleton), wire])
    assert "something else stands" not in reasons(skeleton)
    assert "something else stands" in reasons(skeleton, scan, review={"other_wood": 0.05})


def test_a_tip_that_touches_another_leader_may_be_its_foot() -> None:
    skeleton = drawn()
    xyz = skeleton.xyz.copy()
    long = (skeleton.label == Label.SIDE_BRANCH) & (xyz[:, 0] < 0.4)
    xyz[long, 0] *= 1.6
    touching = replace(skeleton, xyz=xyz)
    assert "its tip touches leader 2: it may belong to it" in reasons(touching, tubes(touching))


def test_wood_past_the_tip_is_said() -> None:
    skeleton = drawn()
    on = np.column_stack([np.linspace(0.32, 0.5, 400), np.zeros(400), np.full(400, 0.5)])
    across = np.column_stack([np.full(400, 0.35), np.zeros(400), np.linspace(0.35, 0.65, 400)])
    said = "wood goes on past its tip that the skeleton does not have"
    assert said not in reasons(skeleton)
    assert said not in reasons(skeleton, np.concatenate([tubes(skeleton), on])), "not enough of it"
    assert said in reasons(skeleton, np.concatenate([tubes(skeleton), across]))


def test_a_leader_that_lies_level_may_be_a_support() -> None:
    skeleton = drawn(" b\n b\n b\nlllllll\nl\nl\nl\nsts\n t\n o")
    assert "its leader lies level there: it may be a support" in reasons(skeleton, tubes(skeleton))


def test_points_not_seen_make_a_branch_doubtful() -> None:
    tree = as_it_is(drawn())
    unseen = replace(tree, seen=tree.skeleton.label != Label.SIDE_BRANCH)
    (cut,) = plan_cuts(unseen, tubes(tree.skeleton)).cuts
    assert "only 0% of it has points" in cut.reasons


def test_cuts_are_on_side_branches_or_by_a_rule_for_leaders(plan: Plan, found: Result) -> None:
    label = {limb.name: limb.label for limb in Limbs.of(found.refined.skeleton).all}
    allowed = {"side_branches": Label.SIDE_BRANCH, "spacing": Label.LEADER, "height": Label.LEADER}
    assert len(plan.cuts) > 5
    assert {cut.rule for cut in plan.cuts} == set(allowed)
    assert all(label[cut.branch] == allowed[cut.rule] for cut in plan.cuts)
    assert all(cut.needs_review for cut in plan.cuts if cut.rule != "side_branches")


def test_every_rule_says_one_thing_of_every_branch_it_is_for(plan: Plan, found: Result) -> None:
    limbs = Limbs.of(found.refined.skeleton)
    asked = {(cut.rule, cut.branch) for cut in plan.cuts}
    left = {(one.rule, one.branch) for one in plan.left}
    leaders = {limb.name for limb in limbs.with_label(Label.LEADER)}
    shoots = {limb.name for limb in limbs.with_label(Label.SIDE_BRANCH)}
    assert not asked & left
    assert asked | left == {
        *(("spacing", name) for name in leaders), *(("height", name) for name in leaders),
        *(("side_branches", name) for name in shoots),
    }  # fmt: skip
    assert len(asked) + len(left) == len(plan.cuts) + len(plan.left)
    assert all(one.why for one in plan.left)


def test_cuts_in_wood_that_another_takes_down_are_for_when_that_stays(
    plan: Plan, found: Result
) -> None:
    limbs = Limbs.of(found.refined.skeleton)
    by_name = {limb.name: limb for limb in limbs.all}
    for cut in plan.cuts:
        gone = limbs.beyond(by_name[cut.branch], cut.along)
        others = [one for one in plan.cuts if one.branch != cut.branch]
        for one in (one for one in others if gone[by_name[one.branch].rows[1]]):
            assert cut.needs_review and any(why.startswith("only if ") for why in one.reasons)


def test_numbers_of_a_cut_fit_each_other(plan: Plan) -> None:
    assert len({cut.id for cut in plan.cuts}) == len(plan.cuts)
    for cut in plan.cuts:
        assert cut.approach is not None
        way, normal = np.array(cut.approach.direction), np.array(cut.blade_normal)
        for vector in (cut.blade_normal, cut.branch_direction, cut.approach.direction):
            assert np.linalg.norm(vector) == pytest.approx(1)
        assert way @ normal == pytest.approx(0, abs=1e-9), "a blade moves in its own plane"
        assert normal @ cut.branch_direction > math.cos(math.radians(46))
        assert way[1] > 0, "away from the camera"
        assert 0 <= cut.confidence <= 1
        assert cut.removed_length > 0 and not cut.removed_volume <= 0
        assert cut.needs_review == bool(cut.reasons)


def test_the_same_tree_gives_the_same_plan(plan: Plan, found: Result) -> None:
    again = plan_cuts(found.refined, found.scan.xyz, EVERYTHING)
    assert repr(again) == repr(plan)


def test_a_moved_tree_gives_the_plan_moved() -> None:
    skeleton = drawn()
    motion = RigidMotion(np.eye(3), np.array([1.0, -2.0, 0.5]))
    (here,) = plan_cuts(skeleton, tubes(skeleton)).cuts
    (there,) = plan_cuts(skeleton.moved(motion), motion.apply(tubes(skeleton))).cuts
    assert there.point == pytest.approx(motion.apply(here.point))
    assert there.id == here.id and there.reasons == here.reasons
    assert there.removed_volume == pytest.approx(here.removed_volume)


def test_a_scan_that_is_elsewhere_and_trees_of_nothing_do_no_harm() -> None:
    (cut,) = plan_cuts(drawn(), FAR).cuts
    assert cut.approach is not None and cut.approach.half_angle == 90
    bare = Skeleton.build([[0, 0, 0]], [-1], [0])
    assert plan_cuts(bare, FAR) == Plan((), (), shipped_rules())
