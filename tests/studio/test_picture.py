from dataclasses import replace

import numpy as np

from prunus.model import Kind, Label, PointCloud
from prunus.studio.header import header
from prunus.studio.picture import DEPTHS, GREY, KINDS, Picture, Slab, colours_of, thinned
from prunus.studio.words import block, card, legend, quiet
from tests.drawn import tree

HOSTILE = "<img src=x onerror=alert(1)>"


def drawn() -> Picture:
    """The drawn tree, each node its own number, every branch called alike."""
    skeleton = tree()
    nodes = list(range(len(skeleton)))
    cloud = PointCloud.from_xyz(skeleton.xyz)
    return Picture(
        scan=cloud,
        kind=None,
        skeleton=skeleton,
        graph=None,
        machine=None,
        nodes=nodes,
        names=dict.fromkeys(nodes, HOSTILE),
    )


def test_a_thinned_cloud_is_the_same_each_time_and_holds_no_point_twice() -> None:
    rows = thinned(1000, 100)
    assert np.array_equal(rows, thinned(1000, 100))
    assert len(np.unique(rows)) == 100
    assert set(thinned(50, 100).tolist()) == set(range(50))


def test_any_start_of_a_thinned_cloud_is_spread_over_all_of_it() -> None:
    start = thinned(100_000, 10_000)[:1000]
    assert np.histogram(start, 10, (0, 100_000))[0].min() > 60


def test_a_slab_holds_what_lies_between_its_ends() -> None:
    slab = Slab(-0.1, 0.2)
    y = np.array([-0.2, 0.0, 0.3])
    xyz = np.column_stack([y * 0, y, y * 0])
    assert slab.holds(xyz).tolist() == [False, True, False]
    assert slab.holds_edges(np.stack([xyz[:2], xyz[1:]], axis=1)).tolist() == [True, True]
    assert Slab().holds(xyz).all()


def test_points_have_their_own_colour_that_of_their_class_or_grey() -> None:
    cloud = PointCloud.from_xyz(np.eye(3), rgb=np.eye(3, dtype=np.uint8))
    kind = np.array([Kind.WIRE, Kind.TARGET, Kind.STRAY], np.int8)
    picture, rows = Picture(scan=cloud, kind=kind), np.array([2, 0])
    assert colours_of(picture, rows, "rgb").tolist() == [[0, 0, 1], [1, 0, 0]]
    by_class = colours_of(picture, rows, "class").tolist()
    assert by_class == [list(KINDS[Kind.STRAY]), list(KINDS[Kind.WIRE])]
    assert colours_of(picture, rows, "grey").tolist() == [list(GREY)] * 2
    assert list(KINDS) == list(Kind)


def test_by_depth_the_nearest_and_the_farthest_of_the_tree_are_farthest_apart_in_colour() -> None:
    skeleton = replace(tree(), xyz=tree().xyz + np.outer(tree().xyz[:, 2], [0, 0.5, 0]))
    y = np.array([-9.0, *skeleton.xyz[:, 1][[0, -1]], 9.0])
    cloud = PointCloud.from_xyz(np.column_stack([y * 0, y, y * 0]))
    told = colours_of(
        Picture(scan=cloud, kind=None, skeleton=skeleton), np.arange(4), "depth"
    ).tolist()
    assert told[0] == told[1] == list(DEPTHS[0])
    assert told[3] == list(DEPTHS[-1])
    assert told[2] not in (told[0], list(GREY))


def test_the_card_tells_of_edge_and_branch_and_escapes_names() -> None:
    picture = drawn()
    leader = next(b for b in picture.branches if b.label == Label.LEADER)
    told = card(picture, int(leader.rows[1]))
    assert f"{leader.length:.2f} m" in told
    assert "at 90°" in told
    assert "10.0 cm" in told and "confidence unknown" in told
    assert "&lt;img" in told and "<img" not in told


def test_the_legend_counts_branches() -> None:
    assert "3, 0.9 m" in legend(drawn())


def test_nothing_from_outside_is_markup() -> None:
    assert "<img" not in block(quiet(HOSTILE))


def test_the_header_of_a_tree_that_cannot_be_opened_says_why() -> None:
    class Broken:
        class item:  # noqa: N801
            name = HOSTILE

        problem = f"{HOSTILE}: is no cloud"

    told = header(Broken())  # type: ignore[arg-type]
    assert "cannot be opened" in told and "is no cloud" in told and "<img" not in told
