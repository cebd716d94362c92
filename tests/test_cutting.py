"""`prunus cuts` from files: with the cloud, with the cloud found again, without it."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from prunus.batch import Options, Task, do
from prunus.cutting import Source, cut_file, lines_of
from prunus.errors import PrunusError
from prunus.io.clouds import write_cloud
from prunus.io.plans import PlanFile
from prunus.io.skeletons import read_record, write_skeleton
from prunus.measure.cuts import shipped_rules
from prunus.model import FRAMES, RigidMotion
from prunus.params import Parameters
from prunus.stages.confidence import HandmadeScorer
from tests.conftest import simulated
from tests.measure.cuts.trees import drawn
from tests.test_cli import prunus

RULES = shipped_rules()
TO_OPTICAL = RigidMotion(FRAMES["optical"], np.zeros(3)).inverse()


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A scan in a camera's frame, its base at the origin, and what the chain made of it."""
    truth, cloud = simulated(4)
    home = tmp_path_factory.mktemp("cuts")
    xyz = cloud.to_input.apply(cloud.xyz) - truth.xyz[0]
    write_cloud(home / "tree.ply", xyz @ FRAMES["optical"])
    do(Task(home / "tree.ply", home / "out"), Options((0.0, 0.0, 0.0), report=False))
    return home


@pytest.fixture(scope="module")
def plan(folder: Path) -> PlanFile:
    return cut_file(Source(folder / "tree.ply", (0.0, 0.0, 0.0)), RULES)


def test_a_cloud_gives_a_plan_in_its_own_frame(plan: PlanFile, folder: Path) -> None:
    fine, record = read_record(folder / "out" / "refined.json")
    assert plan.input == record.input and plan.skeleton is None
    assert len(plan.cuts) > 3
    for cut in plan.cuts:
        away = np.linalg.norm(fine.xyz - cut.point, axis=1)
        assert away.min() < 0.01, "it lies on the refined tree"
        assert cut.approach is not None
        assert cut.approach.direction[2] > 0, "away from the camera, which looks along z"


def test_a_cloud_is_skeletonized_as_it_was_asked_for(plan: PlanFile, folder: Path) -> None:
    path, base, params = folder / "tree.ply", (0.0, 0.0, 0.0), Parameters()
    fewer = params.changed("input", points=5000)
    asked = [(fewer, 0, None), (fewer, 1, None), (fewer, 1, HandmadeScorer())]
    found = [plan] + [
        cut_file(Source(path, base, params=params, seed=seed, scorer=scorer), RULES)
        for params, seed, scorer in asked
    ]
    points = [[cut.point for cut in one.cuts] for one in found]
    assert all(points.count(one) == 1 for one in points), "each of them changes the skeleton"


@pytest.mark.parametrize("name", ["skeleton.json", "refined.json"])
def test_a_skeleton_finds_its_cloud_and_gives_nearly_the_same_plan(
    name: str, plan: PlanFile, folder: Path
) -> None:
    again = cut_file(Source(folder / "out" / name), RULES)
    assert again.input == plan.input and again.skeleton == name
    ours = {cut.id: np.array(cut.point) for cut in plan.cuts}
    theirs = {cut.id: np.array(cut.point) for cut in again.cuts}
    both = ours.keys() & theirs.keys()
    assert len(both) >= 0.8 * len(ours)
    assert np.median([np.linalg.norm(ours[k] - theirs[k]) for k in both]) < 0.005


def test_without_its_cloud_every_cut_is_for_a_person(tmp_path: Path) -> None:
    write_skeleton(tmp_path / "skeleton.json", drawn().moved(TO_OPTICAL))
    plan = cut_file(Source(tmp_path / "skeleton.json"), RULES)
    (cut,) = plan.cuts
    assert cut.needs_review and cut.approach is None and plan.input is None
    assert cut.point == pytest.approx((0.03, -0.5, 0.0)), "leaders point up, whatever the frame"
    assert cut.branch_direction == pytest.approx((1, 0, 0))
    assert plan.notes[0].startswith("no cloud: ")


def test_a_cloud_that_was_asked_for_and_is_not_there_is_an_error(
    folder: Path, tmp_path: Path
) -> None:
    source = Source(folder / "out" / "skeleton.json", scans=tmp_path)
    with pytest.raises(PrunusError, match=r"tree\.ply"):
        cut_file(source, RULES)


def test_what_is_said_names_cuts_reasons_and_why_branches_stay(plan: PlanFile) -> None:
    text = "\n".join(lines_of(plan))
    looked = sum(cut.needs_review for cut in plan.cuts)
    assert f"{len(plan.cuts)} cuts, {looked} of them for a person to look at first" in text
    assert all(cut.id in text for cut in plan.cuts)
    assert all(reason in text for cut in plan.cuts for reason in cut.reasons)
    assert "height: leader 1 stays: " in text


def test_the_command_writes_the_plan_and_speaks_json(folder: Path, tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text("[side_branches]\nlonger_than = 5\n")
    words = ["cuts", folder / "out" / "skeleton.json", "--rules", tmp_path / "mine.toml"]
    done = prunus(*words, "-o", tmp_path / "plan.json", "--json")
    assert done.exit_code == 0, done.output
    held = json.loads(done.stdout)
    assert held == json.loads((tmp_path / "plan.json").read_text())
    assert not [cut for cut in held["cuts"] if cut["rule"] == "side_branches"]
    assert held["rules"]["side_branches"]["longer_than"] == 5


def test_bad_rules_are_one_clear_line(folder: Path, tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text("[side_branches]\nlonger = 5\n")
    done = prunus("cuts", folder / "tree.ply", "--rules", tmp_path / "mine.toml")
    assert done.exit_code == 2
    assert "mine.toml: side_branches.longer: unknown" in done.stderr


def test_a_plan_goes_into_a_bag_as_poses(folder: Path, plan: PlanFile, tmp_path: Path) -> None:
    from rosbags.highlevel import AnyReader

    from prunus.io.plans import write_plan

    write_plan(tmp_path / "plan.json", plan)
    words = ["convert", folder / "out" / "refined.json"]
    done = prunus(*words, tmp_path / "tree.mcap", "--cuts", tmp_path / "plan.json")
    assert done.exit_code == 0, done.output
    with AnyReader([tmp_path / "tree.mcap"]) as bag:
        ((_, _, raw),) = bag.messages([c for c in bag.connections if c.topic == "/cuts"])
        poses = bag.deserialize(raw, "geometry_msgs/msg/PoseArray").poses
    places = [(p.position.x, p.position.y, p.position.z) for p in poses]
    assert places == [cut.point for cut in plan.cuts]
    done = prunus(*words, tmp_path / "tree.glb", "--cuts", tmp_path / "plan.json")
    assert done.exit_code == 2 and "tree.glb: holds no cuts" in done.stderr


def test_a_corrected_skeleton_with_points_of_its_own_is_planned_too(
    folder: Path, tmp_path: Path
) -> None:
    skeleton, record = read_record(folder / "out" / "skeleton.json")
    free = replace(skeleton, superpoint=np.full(len(skeleton), -1))
    write_skeleton(folder / "out" / "corrected.json", free, input=record.input)
    assert cut_file(Source(folder / "out" / "corrected.json"), RULES).input is not None
