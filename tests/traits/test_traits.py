"""Traits, on a drawn tree with numbers worked out by hand."""

import math
from pathlib import Path

import numpy as np
import pytest

from prunus.cuts.limbs import Limbs
from prunus.model import Floats, Label, PointCloud, Skeleton
from prunus.model.branches import branches
from prunus.refine.radii import Unknown
from prunus.refine.refined import Refined, refined
from prunus.traits.definitions import BRANCH_TRAITS, TREE_TRAITS
from prunus.traits.sizes import Limb as TraitsLimb
from prunus.traits.sizes import Record
from prunus.traits.traits import branch_traits, tree_traits

DOCS = Path(__file__).resolve().parents[2] / "docs" / "measures.md"


def drawn(radius: Floats | None = None) -> Refined:
    """A trunk of 40 cm, a level support to the right, one upright leader, one side branch.

    A node every 10 cm. The side branch leaves the leader at a right angle, away from the cameras.
    """
    trunk = [[0, 0, 0.1 * k] for k in range(5)]
    support = [[0.1 * k, 0, 0.4] for k in range(1, 5)]
    leader = [[0.2, 0, 0.4 + 0.1 * k] for k in range(1, 9)]
    side = [[0.2, 0.1 * k, 0.8] for k in range(1, 4)]
    parent = [-1, 0, 1, 2, 3, 4, 5, 6, 7, 6, *range(9, 16), 12, 17, 18]
    label = [0] * 5 + [1] * 4 + [2] * 8 + [3] * 3
    told = np.repeat([0.04, 0.02, 0.01, 0.004], [5, 4, 8, 3]) if radius is None else radius
    skeleton = Skeleton.build(trunk + support + leader + side, parent, label, radius=told)
    seen = np.ones(len(label), np.bool_)
    seen[-1] = False
    unknown = np.where(np.isnan(told), Unknown.RAGGED, Unknown.KNOWN)
    return Refined(
        skeleton=skeleton,
        radius_error=np.where(np.isnan(told), np.nan, 0.001),
        unknown=unknown,
        seen=seen,
        likely=told * np.nan,
    )


def of(label: Label, tree: Refined | None = None) -> Record:
    """The traits of the one branch of that label."""
    (row,) = (r for r in branch_traits(tree or drawn()) if r["label"] == label.word)
    return row


def test_lengths_and_heights() -> None:
    leader, side = of(Label.LEADER), of(Label.SIDE_BRANCH)
    assert (leader["path_length_m"], leader["length_m"]) == pytest.approx((0.8, 0.8))
    assert (leader["foot_height_m"], leader["height_m"]) == pytest.approx((0.4, 1.2))
    assert (leader["foot_at_m"], side["foot_at_m"]) == pytest.approx((0.2, 0.4))


def test_who_carries_whom() -> None:
    rows = branch_traits(drawn())
    assert [row["parent"] for row in rows] == [None, 0, 1, 2]
    assert [row["order"] for row in rows] == [0, 1, 2, 3]
    assert [row["side_branches"] for row in rows] == [0, 0, 1, 0]
    assert [row["name"] for row in rows] == ["the trunk", "support 1", "leader 1", "side branch 1"]
    assert [row["zone"] for row in rows] == ["lower", "middle", "middle", "upper"]


def test_directions() -> None:
    support, leader, side = (of(x) for x in (Label.SUPPORT, Label.LEADER, Label.SIDE_BRANCH))
    assert [x["angle_deg"] for x in (support, leader, side)] == pytest.approx([90, 90, 90])
    assert leader["lean_deg"] == pytest.approx(0)
    assert (support["lean_deg"], side["lean_deg"]) == pytest.approx((90, 90))
    assert (support["azimuth_deg"], side["azimuth_deg"]) == pytest.approx((0, 90))


def test_diameters_start_outside_the_parent() -> None:
    radius = np.repeat([0.04, 0.02, 0.0, 0.004], [5, 4, 8, 3])
    radius[9:17] = 0.012 - 0.001 * np.arange(1, 9)
    leader = of(Label.LEADER, drawn(radius))
    assert leader["diameter_base_mm"] == pytest.approx(22), "nothing is known within the support"
    assert leader["diameter_middle_mm"] == pytest.approx(16)
    assert leader["diameter_30cm_mm"] == pytest.approx(18)
    assert leader["diameter_base_error_mm"] == pytest.approx(2)
    assert leader["cross_section_cm2"] == pytest.approx(math.pi * 1.1**2)


def test_a_short_branch_has_no_diameter_at_30_cm() -> None:
    radius = drawn().skeleton.radius
    tree = drawn(radius)
    short = Refined(
        skeleton=tree.skeleton.part(np.arange(20) < 19),
        radius_error=tree.radius_error[:19],
        unknown=tree.unknown[:19],
        seen=tree.seen[:19],
        likely=tree.likely[:19],
    )
    assert math.isnan(of(Label.SIDE_BRANCH, short)["diameter_30cm_mm"])
    assert of(Label.SIDE_BRANCH)["diameter_30cm_mm"] == pytest.approx(8)


def test_wood_is_that_of_cut_cones() -> None:
    trunk, side = of(Label.TRUNK), of(Label.SIDE_BRANCH)
    assert trunk["volume_cm3"] == pytest.approx(math.pi * 4**2 * 40)
    assert trunk["surface_cm2"] == pytest.approx(2 * math.pi * 4 * 40)
    assert side["volume_cm3"] == pytest.approx(math.pi * 0.4**2 * 29), "outside the leader"


def test_an_unknown_radius_gives_no_number_and_a_reason() -> None:
    radius = drawn().skeleton.radius.copy()
    radius[9:17] = np.nan
    leader = of(Label.LEADER, drawn(radius))
    for name in ("diameter_base_mm", "diameter_middle_mm", "volume_cm3", "cross_section_cm2"):
        assert math.isnan(leader[name])
    assert leader["diameter_missing"] == "ragged"
    assert leader["path_length_m"] == pytest.approx(0.8)
    assert tree_traits(drawn(radius))["diameters_known_share"] == pytest.approx(11 / 19)


def test_what_the_scan_supports() -> None:
    assert of(Label.SIDE_BRANCH)["seen_share"] == pytest.approx(2 / 3)
    assert tree_traits(drawn())["seen_share"] == pytest.approx(18 / 19)


def test_traits_of_the_tree() -> None:
    tree = tree_traits(drawn())
    assert (tree["height_m"], tree["width_m"], tree["depth_m"]) == pytest.approx((1.2, 0.4, 0.3))
    assert (tree["supports"], tree["leaders"], tree["side_branches"]) == (1, 1, 1)
    assert (tree["side_branches_upper"], tree["side_branches_lower"]) == (1, 0)
    assert tree["side_branches_per_leader"] == 1
    assert tree["leader_length_m"] == pytest.approx(0.8)
    assert math.isnan(tree["leader_spacing_m"])
    assert tree["trunk_cross_section_cm2"] == pytest.approx(math.pi * 4**2)
    rows = branch_traits(drawn())
    assert tree["volume_cm3"] == pytest.approx(sum(row["volume_cm3"] for row in rows))


def test_the_base_alone_has_no_branches_and_no_leaders() -> None:
    bare = Skeleton.build([[0, 0, 0]], [-1], [0])
    unknown = np.full(1, np.nan)
    tree = Refined(
        skeleton=bare,
        radius_error=unknown,
        unknown=np.ones(1, np.int64),
        seen=np.zeros(1, np.bool_),
        likely=unknown,
    )
    assert branch_traits(tree) == []
    assert tree_traits(tree)["leaders"] == 0
    assert math.isnan(tree_traits(tree)["trunk_cross_section_cm2"])


def test_every_trait_is_of_its_kind() -> None:
    for rows, defined in (
        (branch_traits(drawn()), BRANCH_TRAITS),
        ([tree_traits(drawn())], TREE_TRAITS),
    ):
        for row in rows:
            assert list(row) == list(defined)
            for name, value in row.items():
                assert value is None or isinstance(value, defined[name].kind), name


def test_the_docs_define_every_trait() -> None:
    text = DOCS.read_text()
    for defined in (BRANCH_TRAITS, TREE_TRAITS):
        for name, trait in defined.items():
            assert f"| `{name}` | {trait.unit} | {trait.definition} |" in text, name


def test_traits_and_cuts_know_one_place_where_a_branch_comes_out_of_its_parent(
    scanned: tuple[Skeleton, PointCloud],
) -> None:
    truth, cloud = scanned
    tree = refined(truth, cloud)
    limbs = Limbs.of(tree.skeleton, tree.names)
    found = branches(tree.skeleton)
    assert len(limbs.all) == len(found) > 10
    for limb, branch in zip(limbs.all, found, strict=True):
        above = found[limb.parent] if limb.parent >= 0 else None
        assert TraitsLimb(tree, branch, above).inner == limb.bark
