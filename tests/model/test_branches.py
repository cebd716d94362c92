"""Branches, leaders, remarks, on drawn trees with numbers worked out by hand."""

import numpy as np
import pytest

from prunus.model import Label, PointCloud, Skeleton
from prunus.model.branches import branches, lengths_by_label
from prunus.model.leaders import leaders
from prunus.model.remarks import explained_points, remarks
from prunus.pipeline import skeletonize
from tests.conftest import simulated
from tests.drawn import tree


def test_branches_of_the_drawn_tree() -> None:
    skeleton = tree()
    count = {label: len(branches(skeleton, label)) for label in Label}
    assert count == {Label.TRUNK: 1, Label.SUPPORT: 2, Label.LEADER: 3, Label.SIDE_BRANCH: 1}
    assert sum(len(branch.rows) - 1 for branch in branches(skeleton)) == len(skeleton) - 1
    lengths = lengths_by_label(skeleton)
    assert lengths[Label.TRUNK] == pytest.approx(0.2)
    assert lengths[Label.LEADER] == pytest.approx(0.9)
    assert sum(lengths.values()) == pytest.approx(skeleton.lengths.sum())


def test_leaders_from_left_to_right() -> None:
    found = leaders(tree())
    assert [leader.x for leader in found] == pytest.approx([0, 0.4, 0.7])
    assert [leader.height for leader in found] == pytest.approx([0.3] * 3)
    assert [leader.lean for leader in found] == pytest.approx([0] * 3)
    assert [leader.spacing for leader in found][1:] == pytest.approx([0.4, 0.3])
    assert np.isnan(found[0].spacing)
    assert [leader.side_branches for leader in found] == [0, 1, 0]


def test_the_base_alone_has_no_branches() -> None:
    bare = Skeleton.build([[0, 0, 0]], [-1], [0])
    assert branches(bare) == []
    assert leaders(bare) == []


def test_remarks_say_what_is_missing() -> None:
    truth, cloud = simulated(2)
    found = skeletonize(cloud, truth.xyz[0])
    whole = explained_points(found.in_house, found.graph)
    base = int(found.graph.base)
    bare = Skeleton.build(found.in_house.xyz[:1], [-1], [0], superpoint=[base])
    said = remarks(bare, found.graph)
    assert said[:2] == ["no support was found", "no leader was found"]
    assert "of the points are not explained by any branch" in said[2]
    assert said[3] == f"{len(found.graph.tips)} of {len(found.graph.tips)} tips were not reached"
    assert explained_points(bare, found.graph) < whole < 1


def test_a_support_that_ends_early_is_named_by_its_side() -> None:
    truth, cloud = simulated(4)
    points = cloud.to_input.apply(cloud.xyz)
    side = np.sign(points[np.abs(points[:, 0]).argmax(), 0])
    stray = np.array([[side * (np.abs(points[:, 0]).max() + 0.6), 0, 1.0]])
    patch = stray + np.random.default_rng(0).normal(0, 0.02, (400, 3))
    wider = PointCloud.from_xyz(np.concatenate([points, patch]))
    name = "right" if side > 0 else "left"
    assert any(
        f"the {name} support ends" in text and "m before the scan does" in text
        for text in skeletonize(wider, truth.xyz[0]).warnings
    )
