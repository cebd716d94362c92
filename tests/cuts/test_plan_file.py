"""`prunus cuts` from files: with the cloud, with the cloud found again, without it."""

import csv
import json
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from prunus.batch.run import Options, Task, do
from prunus.cuts import shipped_rules
from prunus.cuts.plan_file import Source, cut_file, lines_of
from prunus.errors import PrunusError
from prunus.io.clouds.cloud_file import write_cloud
from prunus.io.skeletons.plans import PlanFile, write_plan
from prunus.io.skeletons.skeleton_file import (
    read_record,
    read_skeleton,
    sha256_of,
    write_skeleton,
)
from prunus.io.skeletons.swc import write_swc
from prunus.model import FRAMES, RigidMotion
from prunus.model.branches import branch_of_rows, branches
from prunus.paper.confidence import ConstantScorer
from prunus.params import Parameters
from tests.conftest import simulated
from tests.cuts.trees import drawn
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
    do(
        Task(home / "tree.ply", home / "out"),
        Options(base=(0.0, 0.0, 0.0), report=False, traits=True),
    )
    return home


@pytest.fixture(scope="module")
def plan(folder: Path) -> PlanFile:
    return cut_file(Source(path=folder / "tree.ply", base=(0.0, 0.0, 0.0)), RULES)


def test_a_cloud_gives_a_plan_in_its_own_frame(plan: PlanFile, folder: Path) -> None:
    fine, record = read_record(folder / "out" / "refined.json")
    assert plan.input == record.input and plan.skeleton is None
    assert len(plan.cuts) > 3
    for cut in plan.cuts:
        away = np.linalg.norm(fine.xyz - cut.point, axis=1)
        assert away.min() < 0.01, "it lies on the refined tree"
        assert cut.approach is not None
        assert cut.approach.direction[2] > 0, "away from the camera, which looks along z"


@pytest.mark.slow
def test_a_cloud_is_skeletonized_as_it_was_asked_for(plan: PlanFile, folder: Path) -> None:
    path, base = folder / "tree.ply", (0.0, 0.0, 0.0)
    fewer, paper = (
        params.changed("input", points=5000) for params in (Parameters(), Parameters.paper())
    )
    asked = [(fewer, 0, None), (fewer, 1, None), (paper, 1, None), (paper, 1, ConstantScorer(0.9))]
    found = [plan] + [
        cut_file(Source(path=path, base=base, params=params, seed=seed, scorer=scorer), RULES)
        for params, seed, scorer in asked
    ]
    points = [[cut.point for cut in one.cuts] for one in found]
    assert all(points.count(one) == 1 for one in points), "each of them changes the skeleton"


@pytest.mark.parametrize("name", ["skeleton.json", "refined.json"])
def test_a_skeleton_finds_its_cloud_and_gives_the_plan_of_the_cloud(
    name: str, plan: PlanFile, folder: Path
) -> None:
    again = cut_file(Source(path=folder / "out" / name), RULES)
    assert again.input == plan.input and again.skeleton == name
    assert again.skeleton_sha256 == plan.skeleton_sha256
    assert again.left == plan.left
    for cut, other in zip(plan.cuts, again.cuts, strict=True):
        assert cut.confidence == pytest.approx(other.confidence, abs=2e-4)
        assert cut.needs_review == other.needs_review and len(cut.reasons) == len(other.reasons)
        ours, theirs = (one.model_dump(exclude={"confidence", "reasons"}) for one in (cut, other))
        for key in ours:
            assert _numbers(ours[key]) == pytest.approx(_numbers(theirs[key]), abs=2e-5), key


def _numbers(value: Any) -> Any:
    """The numbers in a record, or what else it is."""
    if isinstance(value, dict):
        value = tuple(value.values())
    if isinstance(value, tuple):
        return [number for one in value for number in np.ravel(one).tolist()]
    return value


def test_a_skeleton_without_its_refined_tree_gives_nearly_the_same_plan(
    plan: PlanFile, folder: Path, tmp_path: Path
) -> None:
    for name in ("tree.ply", "out/skeleton.json"):
        shutil.copy(folder / name, tmp_path)
    again = cut_file(Source(path=tmp_path / "skeleton.json"), RULES)
    assert any("refined anew" in note for note in again.notes)
    ours = {cut.id: np.array(cut.point) for cut in plan.cuts}
    theirs = {cut.id: np.array(cut.point) for cut in again.cuts}
    both = ours.keys() & theirs.keys()
    assert len(both) >= 0.8 * len(ours)
    assert np.median([np.linalg.norm(ours[k] - theirs[k]) for k in both]) < 0.005


@pytest.mark.parametrize("name", ["skeleton.json", "refined.json"])
def test_a_skeleton_tells_how_likely_its_branches_are(
    plan: PlanFile, folder: Path, name: str
) -> None:
    again = cut_file(Source(path=folder / "out" / name), RULES)
    here, there = ({cut.id: cut.confidence for cut in one.cuts} for one in (plan, again))
    both = here.keys() & there.keys()
    assert len(both) > 3
    assert all(abs(here[one] - there[one]) < 0.15 for one in both)
    assert max(here[one] for one in both) > 0.3


def test_a_branch_has_one_number_in_every_file(plan: PlanFile, folder: Path) -> None:
    text = (folder / "out" / "traits.csv").read_text()
    rows = list(csv.DictReader(text.splitlines()))
    numbers = {row["name"]: int(row["branch"]) for row in rows}
    assert list(numbers.values()) == list(range(len(rows)))
    for name in ("skeleton.json", "refined.json"):
        skeleton, record = read_record(folder / "out" / name)
        assert record.branch == branch_of_rows(branches(skeleton), len(skeleton)).tolist()
        told = record.branches or (record.trust.branches if record.trust else [])
        assert {one.name: one.number for one in told} == numbers
        for one in told:
            assert {record.branch[node] for node in one.nodes[1:]} == {one.number}
    assert plan.cuts and plan.left
    for one in (*plan.cuts, *plan.left):
        assert one.branch_number == numbers[one.branch]


def test_without_its_cloud_every_cut_is_for_a_person(tmp_path: Path) -> None:
    write_skeleton(tmp_path / "skeleton.json", drawn().moved(TO_OPTICAL))
    plan = cut_file(Source(path=tmp_path / "skeleton.json"), RULES)
    (cut,) = plan.cuts
    assert cut.needs_review and cut.approach is None and plan.input is None
    assert cut.point == pytest.approx((0.03, -0.5, 0.0)), "leaders point up, whatever the frame"
    assert cut.branch_direction == pytest.approx((1, 0, 0))
    assert plan.notes[0].startswith("no cloud: ")


def test_a_cloud_that_was_asked_for_and_is_not_there_is_an_error(
    folder: Path, tmp_path: Path
) -> None:
    source = Source(path=folder / "out" / "skeleton.json", scans=tmp_path)
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


def poses_in(bag: Path, topic: str) -> list[tuple[float, float, float]]:
    """The places in a topic of poses."""
    from rosbags.highlevel import AnyReader

    with AnyReader([bag]) as opened:
        ((_, _, raw),) = opened.messages([c for c in opened.connections if c.topic == topic])
        poses = opened.deserialize(raw, "geometry_msgs/msg/PoseArray").poses
    return [(p.position.x, p.position.y, p.position.z) for p in poses]


def with_one_for_the_machine(plan: PlanFile) -> PlanFile:
    first = plan.cuts[0].model_copy(update={"needs_review": False, "reasons": []})
    return plan.model_copy(update={"cuts": [first, *plan.cuts[1:]]})


def test_a_plan_goes_into_a_bag_those_to_be_looked_at_apart(
    folder: Path, plan: PlanFile, tmp_path: Path
) -> None:
    write_plan(tmp_path / "plan.json", with_one_for_the_machine(plan))
    words = ["convert", folder / "out" / "refined.json"]
    done = prunus(*words, tmp_path / "tree.mcap", "--cuts", tmp_path / "plan.json")
    assert done.exit_code == 0, done.output
    looked = len(plan.cuts) - 1
    assert f"{looked + 1} cuts, {looked} of them in /cuts/review" in done.stderr
    assert poses_in(tmp_path / "tree.mcap", "/cuts") == [plan.cuts[0].point]
    rest = [cut.point for cut in plan.cuts[1:]]
    assert poses_in(tmp_path / "tree.mcap", "/cuts/review") == rest
    done = prunus(*words, tmp_path / "tree.glb", "--cuts", tmp_path / "plan.json")
    assert done.exit_code == 2 and "tree.glb: holds no cuts" in done.stderr


def into_bag(source: Path, plan: PlanFile, home: Path) -> str:
    """What is said where a plan is put into a bag with a skeleton: nothing where it is refused."""
    home.mkdir(exist_ok=True)
    write_plan(home / "plan.json", plan)
    done = prunus("convert", source, home / "tree.mcap", "--cuts", home / "plan.json")
    assert (done.exit_code == 0) == (home / "tree.mcap").exists()
    if done.exit_code:
        said = done.stderr
        assert str(home / "plan.json") in said and str(source) in said, "both are named"
        assert "another skeleton" in said and said.count("\n") == 1
        return ""
    return done.stderr


@pytest.mark.parametrize("planned_on", ["tree.ply", "out/skeleton.json", "out/refined.json"])
@pytest.mark.parametrize("shown_with", ["out/skeleton.json", "out/refined.json"])
@pytest.mark.slow
def test_a_plan_belongs_to_its_skeleton_rough_and_refined(
    planned_on: str, shown_with: str, folder: Path, tmp_path: Path
) -> None:
    base = (0.0, 0.0, 0.0) if planned_on == "tree.ply" else None
    made = cut_file(Source(path=folder / planned_on, base=base), RULES)
    assert made.skeleton_sha256 == sha256_of(read_skeleton(folder / "out" / "skeleton.json"))
    assert "to be looked at" in into_bag(folder / shown_with, made, tmp_path)


def test_where_a_skeleton_is_kept_does_not_matter_but_where_its_nodes_are(
    folder: Path, plan: PlanFile, tmp_path: Path
) -> None:
    skeleton, record = read_record(folder / "out" / "skeleton.json")
    write_swc(tmp_path / "same.swc", skeleton)
    text = (folder / "out" / "skeleton.json").read_text()
    (tmp_path / "same.json").write_text(json.dumps(json.loads(text), indent=3))
    for name in ("same.swc", "same.json"):
        assert into_bag(tmp_path / name, plan, tmp_path / "a")
        (tmp_path / "a" / "tree.mcap").unlink()
    moved = skeleton.xyz.copy()
    moved[-1] += 0.001
    label = skeleton.label.copy()
    label[-1] = (label[-1] + 1) % 4
    kept = np.arange(len(skeleton)) < len(skeleton) - 1
    others = [replace(skeleton, xyz=moved), replace(skeleton, label=label), skeleton.part(kept)]
    for other in others:
        write_skeleton(tmp_path / "corrected.json", other, input=record.input)
        assert not into_bag(tmp_path / "corrected.json", plan, tmp_path / "b")


def test_the_plan_of_another_tree_is_refused(folder: Path, plan: PlanFile, tmp_path: Path) -> None:
    write_skeleton(tmp_path / "other.json", drawn())
    other = cut_file(Source(path=tmp_path / "other.json"), RULES)
    assert not into_bag(folder / "out" / "skeleton.json", other, tmp_path / "a")
    assert not into_bag(folder / "out" / "refined.json", other, tmp_path / "b")
    assert not into_bag(tmp_path / "other.json", plan, tmp_path / "c")
    assert into_bag(tmp_path / "other.json", other, tmp_path / "d")


def test_an_old_plan_goes_by_its_scan(folder: Path, plan: PlanFile, tmp_path: Path) -> None:
    old = plan.model_copy(update={"skeleton_sha256": None})
    assert "does not say of which skeleton" in into_bag(
        folder / "out" / "refined.json", old, tmp_path / "a"
    )
    assert plan.input is not None
    scan = plan.input.model_copy(update={"sha256": "0" * 64})
    other = old.model_copy(update={"input": scan})
    assert not into_bag(folder / "out" / "refined.json", other, tmp_path / "b")


def test_a_refined_skeleton_keeps_the_names_that_the_report_gave(
    folder: Path, tmp_path: Path
) -> None:
    _, record = read_record(folder / "out" / "skeleton.json")
    fine, told = read_record(folder / "out" / "refined.json")
    assert record.trust is not None and told.branches is not None
    names = [branch.name for branch in record.trust.branches]
    assert sorted(branch.name for branch in told.branches) == sorted(names)
    swapped = {"leader 1": "leader 2", "leader 2": "leader 1"}
    branches = [
        branch.model_copy(update={"name": swapped.get(branch.name, branch.name)})
        for branch in told.branches
    ]
    write_skeleton(tmp_path / "refined.json", fine, branches=branches, input=told.input)
    for name, source in {"own": folder / "out", "swapped": tmp_path}.items():
        prunus("convert", source / "refined.json", tmp_path / f"{name}.glb")
    own, other = (trimesh.load(tmp_path / f"{name}.glb").geometry for name in ("own", "swapped"))
    assert set(own) == set(names)
    assert own["leader 1"].bounds.tolist() == other["leader 2"].bounds.tolist()
    assert own["leader 1"].bounds.tolist() != other["leader 1"].bounds.tolist()
    plan = cut_file(Source(path=tmp_path / "refined.json", scans=folder), RULES)
    usual = cut_file(Source(path=folder / "out" / "refined.json"), RULES)
    named = {cut.point: cut.branch for cut in plan.cuts}
    assert named == {c.point: swapped.get(c.branch, c.branch) for c in usual.cuts}
    left = {one.branch: one.why for one in plan.left if one.rule == "height"}
    assert left["leader 1"] == next(
        one.why for one in usual.left if (one.rule, one.branch) == ("height", "leader 2")
    )


def test_a_corrected_skeleton_with_points_of_its_own_is_planned_too(
    folder: Path, tmp_path: Path
) -> None:
    skeleton, record = read_record(folder / "out" / "skeleton.json")
    free = replace(skeleton, superpoint=np.full(len(skeleton), -1))
    write_skeleton(folder / "out" / "corrected.json", free, input=record.input)
    assert cut_file(Source(path=folder / "out" / "corrected.json"), RULES).input is not None
