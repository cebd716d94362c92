"""The corrected skeleton and the edits, on drawn trees with numbers worked out by hand."""

import math
from dataclasses import replace

import numpy as np
import pytest

from prunus.editing.edits import edits, label_ratios
from prunus.lab.evaluate.correction import corrected
from prunus.model import Floats, Label, Skeleton
from tests.drawn import cells, tree

TALL = """
l   l    l
l   l    l
l   lbb  l
l   l    l
ssstssssss
   t
   o
"""
"""Trunk 2 edges, supports 3 and 6, leaders 4 each, a side branch of 2: 25 edges."""
LOST = "\n".join(line[:8] if "l" in line else line for line in TALL.split("\n"))
"""The same without its right leader."""
NODES = np.array([(0.1 * x, 0.0, 0.1 * z) for x, z in sorted(cells(TALL))])


def standing_on(skeleton: Skeleton, nodes: Floats = NODES) -> Skeleton:
    """The skeleton with its superpoints looked up by place."""
    away = np.linalg.norm(skeleton.xyz[:, None] - nodes[None], axis=2)
    assert away.min(axis=1).max() < 1e-9
    return replace(skeleton, superpoint=away.argmin(axis=1))


def right(found: Skeleton, truth: str = TALL, counts: bool = True) -> Skeleton:
    true = tree(truth)
    return corrected(found, NODES, true, np.full(len(true), counts))


def test_the_truth_needs_no_edits() -> None:
    found = standing_on(tree(TALL))
    needed = edits(found, right(found))
    assert (needed.wrong, needed.missing, needed.mislabelled) == (0, 0, 0)
    assert needed.edges == len(found) - 1 == 25
    assert needed.ratio == 0


def test_a_lost_leader_is_drawn_along_its_superpoints() -> None:
    found = standing_on(tree(LOST))
    needed = edits(found, right(found))
    assert (needed.wrong, needed.mislabelled) == (0, 0)
    assert 2 <= needed.missing <= 4, "one of 40 cm, in steps of at most 20 cm"
    assert needed.differing[Label.LEADER] == needed.missing
    assert needed.segments[Label.LEADER] == 3


def test_an_edge_where_nothing_grows_is_wrong() -> None:
    found = tree(TALL)
    astray = Skeleton.build(
        [*found.xyz, (0.15, 0.0, 0.45)], [*found.parent, 1], [*found.label, Label.SUPPORT]
    )
    nodes = np.vstack([NODES, (0.15, 0.0, 0.45)])
    true = tree(TALL)
    stands = standing_on(astray, nodes)
    needed = edits(stands, corrected(stands, nodes, true, np.ones(len(true), bool)))
    assert (needed.wrong, needed.missing, needed.mislabelled) == (1, 0, 0)
    assert needed.ratio == pytest.approx(1 / 25)


def test_a_wrong_label_is_one_edit_an_edge_save_one_where_labels_change() -> None:
    called_support = TALL.replace("l    l", "l    s").replace("lbb  l", "lbb  s")
    found = standing_on(tree(called_support))
    needed = edits(found, right(found))
    assert (needed.wrong, needed.missing) == (0, 0)
    assert needed.mislabelled == 3, "of four edges the lowest has leeway"
    assert needed.differing[Label.LEADER] == needed.differing[Label.SUPPORT] == 3


def test_what_nobody_can_see_need_not_be_found_and_may_stay() -> None:
    bare = standing_on(tree("ssstssssss\n   t\n   o"))
    unseen = edits(bare, right(bare, counts=False))
    assert (unseen.wrong, unseen.missing) == (0, 0)
    whole = standing_on(tree(TALL))
    assert edits(whole, right(whole, counts=False)).ratio == 0


def test_of_two_equal_paths_the_one_given_is_kept() -> None:
    """A superpoint 4 cm beside the leader is as good as the one on it."""
    beside = NODES.copy()
    extra = np.array([(0.03, 0.0, 0.51), (0.03, 0.0, 0.61)])
    nodes = np.vstack([beside, extra])
    true = tree(TALL)
    found = tree(TALL)
    moved = found.xyz.copy()
    for place in extra:
        row = int(
            np.linalg.norm(found.xyz - (0.0, 0.0, round(place[2] - 0.01, 1)), axis=1).argmin()
        )
        moved[row] = place
    stands = standing_on(replace(found, xyz=moved), nodes)
    assert edits(stands, corrected(stands, nodes, true, np.ones(len(true), bool))).ratio == 0


def test_label_ratios_are_normalized_by_segments_and_the_mean_segment_of_the_set() -> None:
    small = standing_on(tree(TALL))
    found = standing_on(tree(LOST))
    one, other = edits(small, right(small)), edits(found, small)
    assert other.differing[Label.LEADER] == 4
    ratios = label_ratios([one, other])
    assert ratios[Label.LEADER] == [0, pytest.approx(4 / (3 * 4))]
    assert ratios[Label.SUPPORT] == [0, 0]
    assert one.segments[Label.SUPPORT] == 1, "both supports are one segment a tree"
    assert one.segment_edges[Label.SUPPORT] == 9


def test_a_label_that_the_corrected_tree_lacks_has_no_ratio() -> None:
    bare = standing_on(tree("ssstssssss\n   t\n   o"))
    ratios = label_ratios([edits(bare, bare)])
    assert math.isnan(ratios[Label.LEADER][0])
    assert ratios[Label.TRUNK] == [0]


def test_the_corrected_skeleton_is_a_tree_from_the_same_base() -> None:
    found = standing_on(tree(TALL))
    star = right(found)
    assert star.superpoint[0] == found.superpoint[0]
    assert len(np.unique(star.superpoint)) == len(star)


def test_a_branch_that_runs_beside_its_parent_may_begin_anywhere_along_it() -> None:
    """Nobody sees where in one thick piece of wood a second begins."""
    xyz = [(0, 0, 0), (0, 0, 0.2), (0.2, 0, 0.2), (0.4, 0, 0.2), (0.6, 0, 0.2), (0.8, 0, 0.2)]
    leader = [(0.4, 0, 0.22), (0.6, 0, 0.22), (0.6, 0, 0.4), (0.6, 0, 0.6)]
    labels = [0, 0, 1, 1, 1, 1, 2, 2, 2, 2]
    truth = Skeleton.build([*xyz, *leader], [-1, 0, 1, 2, 3, 4, 2, 6, 7, 8], labels)
    nodes = np.array([*xyz, *leader[-2:]], np.float64)
    found = Skeleton.build(
        nodes, [-1, 0, 1, 2, 3, 4, 4, 6], [0, 0, 1, 1, 1, 1, 2, 2], superpoint=np.arange(8)
    )
    assert edits(found, corrected(found, nodes, truth, np.ones(len(truth), bool))).ratio == 0
