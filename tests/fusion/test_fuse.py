"""Views to one cloud: poses are found again, what flies is dropped, what does not fit stays out."""

import json
import math
from dataclasses import replace
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from typer.testing import CliRunner

from prunus.cli import app
from prunus.errors import PrunusError
from prunus.fusion.fuse import VOXEL_M, fuse
from prunus.fusion.normal_equations import partners
from prunus.fusion.pixels import company
from prunus.fusion.registration import turn_of, turned
from prunus.fusion.views import back_projected, seen
from prunus.io.clouds.cloud_file import read_cloud, write_cloud
from prunus.lab.simulate.orchard import write_simulated
from prunus.model import Camera, CloudView, DepthView, Floats, RigidMotion, RigView
from prunus.schemas import schema
from tests.conftest import field_scan

STILL = RigidMotion(np.eye(3), np.zeros(3))
CAMERA = Camera(fx=100.0, fy=100.0, cx=10.0, cy=10.0)
FIELD = 4
"""Seed of the simulated scan."""


def rig(shifts: dict[int, Floats] | None = None, views: int = 6) -> list[RigView]:
    """Views of a simulated scan as their rig places them; `shifts` (metres) place some worse."""
    scan = field_scan(FIELD)
    H, W = scan.views[0].depth.shape
    camera = Camera(fx=scan.focal, fy=scan.focal, cx=W / 2, cy=H / 2)
    made: list[RigView] = []
    for k, view in enumerate(scan.views[:views]):
        shift = (shifts or {}).get(k, np.zeros(3))
        nominal = RigidMotion(view.nominal.rotation, view.nominal.translation + shift)
        made.append(DepthView(name=f"view_{k}", depth=view.depth, camera=camera, nominal=nominal))
    return made


def errors(poses: list[RigidMotion], true: list[RigidMotion]) -> tuple[Floats, Floats]:
    """Metres and degrees (V,) off the true poses after the best common motion."""
    left, _, right = np.linalg.svd(
        sum(t.rotation @ p.rotation.T for p, t in zip(poses, true, strict=True))
    )
    common = left @ right
    moved = np.array(
        [t.translation - common @ p.translation for p, t in zip(poses, true, strict=True)]
    )
    turns = [
        turn_of(RigidMotion(common @ p.rotation, p.translation), t)
        for p, t in zip(poses, true, strict=True)
    ]
    return (
        np.linalg.norm(moved - moved.mean(axis=0), axis=1),
        np.degrees(np.linalg.norm(turns, axis=1)),
    )


def rods(rng: np.random.Generator) -> Floats:
    """Points (P, 3) on thin rods, some upright, some level, some slanted, about the origin."""
    ways = np.array([[0, 0.1, 1.0], [1, 0, 0.1], [0.5, 0.3, 0.8], [-0.6, 0.2, 0.7]])
    starts = rng.uniform(-0.5, 0.5, (16, 3))
    way = np.repeat(ways / np.linalg.norm(ways, axis=1, keepdims=True), 4, axis=0)
    along = np.arange(0, 0.6, 0.003)
    points = starts[:, None] + along[:, None] * way[:, None]
    return points.reshape(-1, 3) + rng.normal(0, 0.002, (16 * len(along), 3))


def test_a_turn_is_found_again(rng: np.random.Generator) -> None:
    for size in (0.0, 1e-10, 1e-3, 1.0, 3.0):
        turn = size * np.array([0.6, 0.0, 0.8])
        pose = RigidMotion(turned(turn), rng.normal(size=3))
        assert pose.rotation @ pose.rotation.T == pytest.approx(np.eye(3), abs=1e-12)
        assert turn_of(pose, STILL) == pytest.approx(turn, abs=1e-9)


def test_pixels_are_back_projected_through_their_middles() -> None:
    depth = np.zeros((20, 20))
    depth[10, 10], depth[0, 19] = 2.0, 1.0
    points = back_projected(depth, CAMERA)
    assert points == pytest.approx(np.array([[0.095, -0.095, 1.0], [0.01, 0.01, 2.0]]))


def test_company_is_counted_at_like_depth_only() -> None:
    depth = np.array([[1.0, 1.005, 0.0], [0.0, 1.2, 0.0], [1.0, 0.0, 1.205]])
    assert company(depth, 0.011).tolist() == [[1, 1, 0], [0, 1, 0], [0, 0, 1]]


def test_flying_pixels_are_dropped_and_masked_ones_left_out() -> None:
    depth = np.zeros((20, 20))
    depth[:, 8:12] = 1.5
    depth[5, 12] = depth[9, 7] = 1.8
    view = seen(DepthView(name="v", depth=depth, camera=CAMERA, nominal=STILL))
    assert view.flying == 2 and len(view.xyz) == 80
    assert view.xyz[:, 2].max() == 1.5
    mask = np.zeros((20, 20), np.bool_)
    mask[:10] = True
    assert (
        len(seen(DepthView(name="v", depth=depth, camera=CAMERA, nominal=STILL, mask=mask)).xyz)
        == 40
    )


def test_partners_are_near_alike_and_of_other_views() -> None:
    xyz = np.array([[0, 0, 0], [0.01, 0, 0], [0.02, 0, 0], [0.005, 0, 0], [0.015, 0, 0.0]])
    axis = np.array([[0, 0, 1], [0, 0, -1], [0, 0, 1], [1, 0, 0], [0, 0, 1.0]])
    view = np.array([0, 1, 1, 1, 2])
    found = partners(xyz, axis, view, 3, 0.018, 0.9)
    assert found.tolist() == [[-1, 1, 4], [0, -1, 4], [-1, -1, 4], [-1, -1, -1], [0, 1, -1]]


@pytest.mark.slow
def test_poses_of_a_simulated_scan_are_refined() -> None:
    true = [view.pose for view in field_scan(FIELD).views]
    views = rig()
    fused = fuse(views)
    before = errors([view.nominal for view in views], true)
    moved, turns = errors([view.pose for view in fused.views], true)
    assert not any(view.refused for view in fused.views)
    assert before[0].max() > 0.005 and before[1].max() > 0.2
    assert moved.max() < 0.005 and turns.max() < 0.15
    assert moved.mean() < before[0].mean() / 2 and turns.mean() < before[1].mean() / 2
    assert all(view.after < view.before for view in fused.views)
    cells = np.floor((fused.xyz - fused.xyz.min(axis=0)) / VOXEL_M)
    assert len(np.unique(cells, axis=0)) > 0.99 * len(cells)


@pytest.mark.slow
def test_a_common_motion_of_all_views_moves_the_cloud(rng: np.random.Generator) -> None:
    common = RigidMotion(turned(rng.uniform(-1.5, 1.5, 3)), rng.uniform(-3, 3, 3))
    views = rig(views=3)

    def after(pose: RigidMotion) -> RigidMotion:
        return RigidMotion(common.rotation @ pose.rotation, common.apply(pose.translation))

    moved: list[RigView] = [replace(one, nominal=after(one.nominal)) for one in views]
    for one, other in zip(fuse(views).views, fuse(moved).views, strict=True):
        expected = after(one.pose)
        assert other.pose.rotation == pytest.approx(expected.rotation, abs=1e-4)
        assert other.pose.translation == pytest.approx(expected.translation, abs=5e-4)
        assert other.after == pytest.approx(one.after, abs=1e-4)


@pytest.mark.slow
def test_a_view_that_does_not_fit_is_left_out_and_the_others_are_as_without_it() -> None:
    fused = fuse(rig({1: np.array([0.25, 0.0, 0.1])}, views=3))
    assert [bool(view.refused) for view in fused.views] == [False, True, False]
    others = fuse([view for k, view in enumerate(rig(views=3)) if k != 1])
    for one, other in zip((fused.views[0], fused.views[2]), others.views, strict=True):
        assert one.pose.translation == pytest.approx(other.pose.translation, abs=0.003)


def test_partial_clouds_fit_and_keep_their_colours(rng: np.random.Generator) -> None:
    xyz = rods(rng)
    wrong = RigidMotion(turned(np.radians([0.4, -0.5, 0.3])), np.array([0.01, -0.008, 0.005]))
    colours = np.full((len(xyz), 3), 50, np.uint8)
    far = RigidMotion(np.eye(3), np.array([500_000.0, 5_000_000.0, 300.0]))
    views: list[RigView] = [
        CloudView(name="a", xyz=far.apply(xyz), nominal=STILL, rgb=colours),
        CloudView(
            name="b", xyz=far.apply(wrong.apply(xyz)), nominal=STILL, rgb=colours + np.uint8(1)
        ),
    ]
    fused = fuse(views)
    assert fused.rgb is not None and set(fused.rgb[:, 0].tolist()) == {50, 51}
    first = fused.views[0].pose.apply(far.apply(xyz))
    second = fused.views[1].pose.apply(far.apply(wrong.apply(xyz)))
    assert np.linalg.norm(first - second, axis=1).max() < 0.002
    assert fuse([views[0], CloudView(name="b", xyz=far.apply(xyz), nominal=STILL)]).rgb is None


def test_same_seed_same_cloud(rng: np.random.Generator) -> None:
    views: list[RigView] = [CloudView(name=name, xyz=rods(rng), nominal=STILL) for name in "a"]
    assert (fuse(views, 3).xyz == fuse(views, 3).xyz).all()


def test_one_view_is_only_back_projected(rng: np.random.Generator) -> None:
    xyz = rods(rng)
    fused = fuse([CloudView(name="a", xyz=xyz, nominal=STILL)])
    (view,) = fused.views
    assert view.refused == "" and view.moved == 0 and math.isnan(view.after)
    assert len(fused.xyz) <= len(xyz)


def test_views_without_points_and_views_that_share_nothing_are_refused(
    rng: np.random.Generator,
) -> None:
    empty = DepthView(name="dark", depth=np.zeros((20, 20)), camera=CAMERA, nominal=STILL)
    with pytest.raises(PrunusError, match="hold no points"):
        fuse([empty])
    tree = CloudView(name="tree", xyz=rods(rng), nominal=STILL)
    with pytest.raises(PrunusError, match=r"no two of 2 views fit.*dark: only 0 samples"):
        fuse([tree, empty])
    with pytest.raises(PrunusError, match="no two of 2 views fit"):
        fuse([tree, CloudView(name="other", xyz=rods(rng) + 5.0, nominal=STILL)])


@pytest.mark.slow
def test_the_command_writes_the_cloud_and_says_the_residuals(tmp_path: Path) -> None:
    write_simulated(tmp_path / "rig", field_scan(FIELD), views=True)
    words = ["fuse", tmp_path / "rig", "-o", tmp_path / "raw.ply", "--report", tmp_path / "r.json"]
    done = CliRunner().invoke(app, [str(word) for word in words])
    assert done.exit_code == 0, done.output
    assert done.stdout.count("view_") == 6 and "points written to" in done.stdout
    report = json.loads((tmp_path / "r.json").read_text())
    assert [view["refused"] for view in report["views"]] == [None] * 6
    jsonschema.validate(report, schema("fused"))
    rig = json.loads((tmp_path / "rig" / "rig.json").read_text())
    jsonschema.validate(rig, schema("rig"))
    assert len(read_cloud(tmp_path / "raw.ply").xyz) > 50_000


def test_the_command_stops_at_a_bad_input_and_at_a_bad_option(tmp_path: Path) -> None:
    write_cloud(tmp_path / "top_cloud.ply", np.eye(3))
    for words, status, said in (
        (["fuse", tmp_path / "none", "-o", tmp_path / "raw.ply"], 1, "not a folder"),
        (["fuse", tmp_path, "-o", tmp_path / "raw.stl"], 2, "clouds are not written as '.stl'"),
    ):
        done = CliRunner().invoke(app, [str(word) for word in words])
        assert done.exit_code == status and said in done.output
