"""The bag of ROS 2, opened with rosbags."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from prunus.io.clouds.cloud_file import read_cloud
from prunus.io.ros.transforms import rotation
from prunus.io.ros.write import CutPoses, facing, turned_from_z, write_mcap
from prunus.model import Label, Skeleton
from tests.drawn import tree


@pytest.fixture
def skeleton() -> Skeleton:
    drawn = tree()
    return drawn.with_radius(np.full(len(drawn), 0.01))


def said(path: Path) -> dict[str, Any]:
    from rosbags.highlevel import AnyReader

    with AnyReader([path]) as bag:
        return {c.topic: bag.deserialize(raw, c.msgtype) for c, _, raw in bag.messages()}


def test_the_tree_is_a_cylinder_an_edge(skeleton: Skeleton, tmp_path: Path) -> None:
    write_mcap(tmp_path / "t.mcap", skeleton)
    told = said(tmp_path / "t.mcap")
    assert set(told) == {"/tree"}
    markers = told["/tree"].markers
    assert [marker.id for marker in markers] == list(range(1, len(skeleton)))
    for marker in markers:
        assert marker.type == marker.CYLINDER
        assert marker.action == marker.ADD
        assert marker.ns == Label(skeleton.label[marker.id]).word
        assert marker.color.a == 1
        at, turn, size = marker.pose.position, marker.pose.orientation, marker.scale
        axis = rotation(np.array([turn.x, turn.y, turn.z, turn.w]))[:, 2] * size.z
        end = np.array([at.x, at.y, at.z]) + axis / 2
        assert end == pytest.approx(skeleton.xyz[marker.id])
        assert end - axis == pytest.approx(skeleton.xyz[skeleton.parent[marker.id]])
        assert size.x == size.y == pytest.approx(0.02)


@pytest.mark.parametrize("coloured", [True, False])
def test_the_cloud_comes_back(skeleton: Skeleton, tmp_path: Path, coloured: bool) -> None:
    rng = np.random.default_rng(0)
    xyz = rng.normal(size=(500, 3))
    rgb = rng.integers(0, 256, (500, 3)).astype(np.uint8) if coloured else None
    write_mcap(tmp_path / "t.mcap", skeleton, (xyz, rgb))
    back = read_cloud(tmp_path / "t.mcap")
    assert back.xyz == pytest.approx(xyz, abs=1e-6)
    assert (back.rgb is None) == (rgb is None)
    assert rgb is None or (back.rgb == rgb).all()


@pytest.mark.parametrize("review", [[], [True], [False], [False, True, True, False, True]])
def test_every_cut_is_a_pose_in_the_topic_of_its_kind_and_has_its_id_there(
    skeleton: Skeleton, tmp_path: Path, review: list[bool]
) -> None:
    places = np.arange(3.0 * len(review)).reshape(-1, 3)
    ways = np.where(np.arange(len(review))[:, None] % 2, (0, 0, -1.0), (0, 0, 1.0))
    ids = [f"spacing:leader-{number}" for number in range(len(review))]
    cuts = CutPoses(
        ids=ids,
        places=places,
        turns=turned_from_z(ways.reshape(-1, 3)),
        review=np.array(review, bool),
    )
    write_mcap(tmp_path / "t.mcap", skeleton, cuts=cuts)
    told = said(tmp_path / "t.mcap")
    assert set(told) == {"/tree", "/cuts", "/cuts/review", "/cuts/ids"}
    assert len(told["/cuts"].poses) == review.count(False)
    assert len(told["/cuts/review"].poses) == review.count(True)
    markers = told["/cuts/ids"].markers
    assert [marker.text for marker in markers] == ids
    for number, (marker, looked) in enumerate(zip(markers, review, strict=True)):
        assert marker.ns == ("/cuts/review" if looked else "/cuts")
        assert marker.type == marker.TEXT_VIEW_FACING and marker.scale.z > 0
        pose = told[marker.ns].poses[marker.id]
        assert [pose.position.x, pose.position.y, pose.position.z] == places[number].tolist()
        assert pose.orientation.w == (0 if number % 2 else 1)


def test_without_a_plan_there_is_no_topic_of_cuts(skeleton: Skeleton, tmp_path: Path) -> None:
    write_mcap(tmp_path / "t.mcap", skeleton)
    assert set(said(tmp_path / "t.mcap")) == {"/tree"}


def test_the_same_tree_is_the_same_file(skeleton: Skeleton, tmp_path: Path) -> None:
    for name in ("a.mcap", "b.mcap"):
        write_mcap(tmp_path / name, skeleton)
    assert (tmp_path / "a.mcap").read_bytes() == (tmp_path / "b.mcap").read_bytes()


def test_a_cut_faces_along_its_normal_and_its_way() -> None:
    rng = np.random.default_rng(1)
    normal, other = (
        v / np.linalg.norm(v, axis=1, keepdims=True) for v in rng.normal(size=(2, 50, 3))
    )
    normal[0], other[0] = (0, 0, -1), (1, 0, 0)
    way = np.cross(normal, other)
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    for turn, z, x in zip(facing(normal, way), normal, way, strict=True):
        assert rotation(turn) @ np.eye(3) == pytest.approx(np.column_stack([x, np.cross(z, x), z]))
    unknown = facing(normal, np.zeros_like(normal))
    assert [rotation(turn)[:, 2] for turn in unknown] == [pytest.approx(z) for z in normal]
