"""The pruning plan of a tree under correction."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from prunus.editing import AddPath, Relabel, RemoveBranch, State, branch_names
from prunus.errors import PrunusError
from prunus.files.work_folder import PLAN
from prunus.geometry.near import away_from
from prunus.io.clouds.cloud_file import write_cloud
from prunus.io.skeletons.plans import read_plan, write_plan
from prunus.io.skeletons.skeleton_file import read_skeleton, sha256_of
from prunus.lab.simulate import simulate_scan
from prunus.model import Label
from prunus.pipeline import skeletonize
from prunus.session import Settings, Work
from prunus.studio.planned import _vouched, file_of, planned, save, told_of_file
from prunus.studio.shelf import Item
from prunus.studio.tree import Tree
from tests.conftest import simulated
from tests.editing.trees import FAR
from tests.studio.conftest import until

QUICK = Settings(frame="z-up")


@pytest.fixture(scope="module")
def scan_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A clean scan of a simulated tree, far from the origin."""
    path = tmp_path_factory.mktemp("scans") / "elm.ply"
    cloud = simulate_scan(3, "clean").target_cloud().sample(8000, np.random.default_rng(0))
    write_cloud(path, cloud.to_input.apply(cloud.xyz) + FAR)
    return path


@pytest.fixture
def work(scan_file: Path, tmp_path: Path) -> Iterator[Work]:
    with Work.open(scan_file, tmp_path / "elm", QUICK) as opened:
        yield opened


def some(work: Work, label: Label) -> int:
    """The first node of the first branch of a label."""
    draft = work.state.draft
    return next(node for node in draft.nodes[1:] if draft.into[node][1] == label)


@pytest.mark.parametrize("seed", [970000, 970002])
def test_a_cut_is_on_the_branch_of_its_name(seed: int) -> None:
    truth, cloud = simulated(seed)
    state = State.of(skeletonize(cloud, truth.xyz[0]))
    found, told = planned(state), branch_names(state.draft)
    assert len(found.plan.cuts) > 3
    for cut in found.plan.cuts:
        assert told[found.node[cut.branch]] == cut.branch
        first = state.draft.branch(found.node[cut.branch])[0]
        line = state.draft.places[[state.draft.into[first][0], *state.draft.branch(first)]]
        assert away_from(np.array([cut.point]), line)[0] < 0.05, cut.branch
    assert {one.branch for one in found.plan.left} <= set(told.values())


def test_what_a_person_told_is_sure(work: Work) -> None:
    before = _vouched(work.state, work.state.draft.numbered())
    node = some(work, Label.SIDE_BRANCH)
    work.do(Relabel(node, Label.SIDE_BRANCH, "edge"))
    after = _vouched(work.state, work.state.draft.numbered())
    row = work.state.draft.nodes.index(node)
    assert after[row] == 1.0
    others = np.arange(len(after)) != row
    assert np.array_equal(after[others], before[others])
    assert np.isfinite(after).all()


def test_a_branch_drawn_by_hand_is_as_sure_as_its_person(work: Work) -> None:
    draft = work.state.draft
    start = some(work, Label.LEADER)
    stops = draft.places[start] + np.array([[0.15, -0.02, 0.02], [0.3, -0.02, 0.05]])
    free = [tuple(row) for row in work.state.scan.to_input.apply(stops).tolist()]
    state = work.do(AddPath((start, *free), Label.SIDE_BRANCH, routed=False))
    name = branch_names(state.draft)[max(state.draft.nodes)]
    (cut,) = [cut for cut in planned(state).plan.cuts if cut.branch == name]
    assert cut.evidence.likely == 1.0
    assert cut.confidence > 0


def test_the_file_is_in_the_frame_of_the_scan_and_names_what_was_planned_on(work: Work) -> None:
    path = work.folder / PLAN
    plan = planned(work.state).plan
    file = file_of(plan, work)
    assert file.skeleton == "skeleton.json" and file.input is not None
    assert file.input.file == "elm.ply"
    low, high = work.scan.file.xyz.min(axis=0), work.scan.file.xyz.max(axis=0)
    places = np.array([cut.point for cut in file.cuts])
    assert ((places > low - 0.05) & (places < high + 0.05)).all()
    write_plan(path, file)
    work.do(RemoveBranch(some(work, Label.SIDE_BRANCH)))
    assert file_of(plan, work).skeleton == "corrected.json"


def test_whether_a_plan_was_saved_is_told(work: Work) -> None:
    path = work.folder / PLAN
    file = file_of(planned(work.state).plan, work)
    assert told_of_file(path, file) == "not saved"
    write_plan(path, file)
    assert told_of_file(path, file) == "saved in plan.json"
    work.do(RemoveBranch(some(work, Label.SIDE_BRANCH)))
    later = file_of(planned(work.state).plan, work)
    assert told_of_file(path, later) == "plan.json is of the tree as it was before"
    path.write_text("no plan")
    assert told_of_file(path, later).startswith("cannot be read:")
    save(path, later)
    assert told_of_file(path, later) == "saved in plan.json"


def test_the_plan_of_another_scan_is_named_and_kept(work: Work) -> None:
    path = work.folder / PLAN
    file = file_of(planned(work.state).plan, work)
    assert file.input is not None
    scan = file.input.model_copy(update={"file": "oak.ply", "sha256": "0" * 64})
    other = file.model_copy(update={"input": scan})
    write_plan(path, other)
    words = "is the plan of another tree, skeleton.json of oak.ply; this is skeleton.json of elm"
    assert words in told_of_file(path, file)
    with pytest.raises(PrunusError, match=f"plan.json: {words}.*; move it away"):
        save(path, file)
    assert read_plan(path) == other


def test_the_plan_names_the_skeleton_in_the_file_beside_it(work: Work) -> None:
    file = file_of(planned(work.state).plan, work)
    assert file.skeleton_sha256 == sha256_of(read_skeleton(work.folder / "skeleton.json"))
    work.do(RemoveBranch(some(work, Label.SIDE_BRANCH)))
    later = file_of(planned(work.state).plan, work)
    assert later.skeleton_sha256 == sha256_of(read_skeleton(work.folder / "corrected.json"))
    assert later.skeleton_sha256 != file.skeleton_sha256


def test_points_that_are_not_the_tree_do_not_draw_it_aside(work: Work) -> None:
    state = work.state
    strayed = state.scan.xyz[:, 0] > np.median(state.scan.xyz[:, 0])
    marked = replace(state, kind=np.where(strayed, np.int8(6), state.kind), marked=True)
    assert not np.array_equal(planned(marked).skeleton.xyz, planned(state).skeleton.xyz)


def test_who_only_reads_saves_no_plan(work: Work, scan_file: Path) -> None:
    tree = Tree(Item("elm", scan_file, work.folder), QUICK)
    tree.watch(lambda: None)
    state = until(lambda: tree.state, "the tree")
    plan = planned(state).plan
    with pytest.raises(PrunusError, match="read-only"):
        tree.save_plan(plan)
    work.close()
    tree.close()
    tree.watch(lambda: None)
    until(lambda: tree.state, "the tree again")
    tree.save_plan(plan)
    assert read_plan(work.folder / PLAN).cuts
    tree.close()
