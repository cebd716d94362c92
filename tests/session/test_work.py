"""One tree being corrected: nothing is lost, and what was done is done again the same."""

import json
import os
import shutil
import signal
import textwrap
from pathlib import Path

import numpy as np
import pytest

from prunus.editing import (
    Act,
    AddPath,
    Box,
    Class,
    Mark,
    MoveBase,
    Rebuild,
    Refused,
    Relabel,
    RemoveBranch,
    RemoveEdge,
    Search,
    SetStatus,
)
from prunus.editing.state import State
from prunus.errors import PrunusError
from prunus.io.clouds.cloud_file import read_cloud, write_cloud
from prunus.io.skeletons.skeleton_file import read_skeleton, write_skeleton
from prunus.model import Kind, Label, Skeleton
from prunus.session import Settings, Work, status_of
from prunus.session import history as memory
from prunus.session.journal import read_journal
from tests.editing.trees import outside, random_act
from tests.processes.children import child
from tests.session.conftest import QUICK


def same(one: Skeleton, other: Skeleton) -> bool:
    """Bit for bit."""
    return all(
        np.array_equal(getattr(one, name), getattr(other, name), equal_nan=True)
        for name in ("xyz", "parent", "label", "confidence", "superpoint")
    )


def same_state(one: State, other: State) -> bool:
    return (
        same(one.draft.numbered(), other.draft.numbered())
        and same(one.result.in_house, other.result.in_house)
        and np.array_equal(one.kind, other.kind)
        and (one.marked, one.done, one.held) == (other.marked, other.done, other.held)
        and np.array_equal(one.draft.places, other.draft.places)
        and (one.base is None) == (other.base is None)
    )


def acted(work: Work, rng: np.random.Generator, count: int) -> None:
    """Do so many acts of any kind, now and then undo and redo."""
    while count:
        try:
            kind = rng.integers(8)
            if kind == 0:
                work.undo()
            elif kind == 1:
                work.redo()
            else:
                work.do(random_act(work.state, rng))
            count -= 1
        except PrunusError:
            continue


def some_leader(work: Work) -> int:
    into = work.state.draft.into
    return next(n for n in work.state.draft.nodes if n in into and into[n][1] == Label.LEADER)


def half_of_the_scan(work: Work) -> Mark:
    """Marks what is beyond the middle of the scan along the row."""
    xyz = work.state.scan.to_input.apply(work.state.scan.xyz)
    low, high = xyz.min(axis=0), xyz.max(axis=0)
    low[0] = work.state.scan.to_input.apply(work.state.draft.places[work.state.draft.base])[0] + 0.3
    return Mark(Box(tuple(low.tolist()), tuple(high.tolist())), Kind.NEIGHBOUR)


def test_at_first_the_tree_is_the_machines(opened: Work, folder: Path) -> None:
    assert opened.acts == []
    assert opened.read_only is None
    assert same(opened.machine, opened.state.draft.skeleton())
    assert status_of(folder) == "new"
    assert read_skeleton(folder / "skeleton.json").superpoint.tolist() == opened.state.draft.nodes
    assert not (folder / "corrected.json").exists()
    assert not (folder / "mask.ply").exists()


def test_the_file_holds_what_was_corrected_in_the_frame_of_the_input(
    opened: Work, folder: Path
) -> None:
    state = opened.do(RemoveBranch(some_leader(opened)))
    written = read_skeleton(folder / "corrected.json")
    expected = state.draft.skeleton().moved(state.scan.to_input)
    assert same(written, expected)
    assert len(written) < len(opened.machine)
    assert status_of(folder) == "in work"
    opened.undo()
    assert not (folder / "corrected.json").exists()
    assert status_of(folder) == "new"


@pytest.mark.parametrize("seed", range(4))
def test_undo_then_redo_is_as_if_nothing_was(opened: Work, seed: int) -> None:
    acted(opened, np.random.default_rng(seed), 12)
    states = [opened.state]
    while (state := opened.undo()) is not None:
        states.append(state)
    assert opened.position == 0
    assert same(opened.state.draft.skeleton(), opened.machine)
    for before in states[-2::-1]:
        assert opened.redo() is not None
        assert same_state(opened.state, before)


@pytest.mark.parametrize("seed", range(4))
def test_the_journal_replays_to_the_same_tree(
    scan_file: Path, folder: Path, opened: Work, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    acted(opened, rng, 6)
    opened.do(Search())
    opened.do(half_of_the_scan(opened))
    acted(opened, rng, 3)
    opened.do(Rebuild())
    acted(opened, rng, 6)
    opened.do(SetStatus(True))
    corrected = (folder / "corrected.json").read_bytes()
    mask = (folder / "mask.ply").read_bytes() if opened.state.marked else b""
    opened.close()
    with Work.open(scan_file, folder) as again:
        assert same_state(again.state, opened.state)
        assert again.acts == opened.acts
        assert again.position == opened.position
        assert not [note for note in again.notes if "journal" in note and "gives" in note]
    assert (folder / "corrected.json").read_bytes() == corrected
    assert not mask or (folder / "mask.ply").read_bytes() == mask


def test_a_new_act_forgets_what_was_undone(opened: Work) -> None:
    first, second = RemoveEdge(opened.state.draft.nodes[-1]), SetStatus(True)
    opened.do(first)
    opened.undo()
    opened.do(second)
    assert opened.acts == [second]
    assert opened.redo() is None


def test_old_states_are_worked_out_again(opened: Work, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(memory, "KEPT", 2)
    acted(opened, np.random.default_rng(0), 12)
    states = [opened.state]
    while (state := opened.undo()) is not None:
        states.append(state)
    for before in states[-2::-1]:
        opened.redo()
        assert same_state(opened.state, before)


def test_a_refused_act_leaves_no_trace(opened: Work, folder: Path) -> None:
    before = (folder / "journal.jsonl").read_bytes()
    first = opened.state.draft.after[opened.state.draft.base][0]
    for act in (RemoveEdge(first), RemoveEdge(99_999), Mark(Class(Kind.POST), Kind.WIRE)):
        with pytest.raises(PrunusError):
            opened.do(act)
    assert (folder / "journal.jsonl").read_bytes() == before
    assert opened.acts == []


def test_what_is_no_act_does_not_reach_the_journal(opened: Work, folder: Path) -> None:
    for wrong in (
        RemoveEdge("one"),
        MoveBase((0.0, 0.0, float("nan"))),
        SetStatus(3),
        Relabel(1, "leader"),
        Relabel(1, Label.LEADER, object()),
    ):
        with pytest.raises(PrunusError):
            opened.do(wrong)
    assert len((folder / "journal.jsonl").read_text().splitlines()) == 1


def test_numbers_of_arrays_are_numbers(opened: Work) -> None:
    node = np.int64(opened.state.draft.nodes[-1])
    place = outside(opened.state, opened.state.draft.places[node] + [0.05, 0, 0.05])
    opened.do(AddPath((node, tuple(np.array(place))), Label(opened.state.draft.into[node][1])))  # type: ignore[arg-type]
    assert opened.position == 1


def test_the_rebuilt_tree_stands_on_the_points_that_are_left(opened: Work, folder: Path) -> None:
    before = opened.machine
    opened.do(half_of_the_scan(opened))
    assert same(opened.machine, before)
    assert (folder / "mask.ply").exists()
    state = opened.do(Rebuild())
    assert len(state.result.scan) == (state.kind == Kind.TARGET).sum() < len(state.scan)
    assert same(opened.machine, state.draft.skeleton())
    assert not same(opened.machine, before)
    assert len(read_skeleton(folder / "skeleton.json")) == len(opened.machine)
    opened.undo()
    assert same(opened.machine, before)
    assert len(read_skeleton(folder / "skeleton.json")) == len(before)
    opened.undo()
    assert not (folder / "mask.ply").exists()


def test_points_that_hold_no_tree_are_not_built_on(opened: Work) -> None:
    opened.do(Mark(Class(Kind.TARGET), Kind.STRAY))
    with pytest.raises(Refused, match="no point is marked as the target"):
        opened.do(Rebuild())


def test_the_second_sees_it_read_only(scan_file: Path, folder: Path, opened: Work) -> None:
    opened.do(RemoveBranch(some_leader(opened)))
    files = {path: path.read_bytes() for path in folder.iterdir()}
    second = Work.open(scan_file, folder, QUICK)
    assert second.read_only is not None
    assert f"process {os.getpid()}" in second.read_only
    assert same_state(second.state, opened.state)
    for move in (lambda: second.do(Search()), second.undo, second.redo):
        with pytest.raises(PrunusError, match="read-only"):
            move()
    second.close()
    assert {path: path.read_bytes() for path in folder.iterdir()} == files
    with pytest.raises(PrunusError, match="is open already, by"):
        Work.open(scan_file, folder, QUICK, read_only_if_locked=False)
    opened.do(SetStatus(True))


def test_a_tree_that_was_closed_is_anothers(scan_file: Path, folder: Path, opened: Work) -> None:
    opened.close()
    with Work.open(scan_file, folder, QUICK) as other:
        assert other.read_only is None
        with pytest.raises(PrunusError, match="was closed"):
            opened.do(Search())


WORKER = """
    import sys
    import numpy as np
    from pathlib import Path
    from prunus.session import Work
    from prunus.errors import PrunusError
    from tests.session.conftest import QUICK
    from tests.editing.trees import random_act

    work, rng = Work.open(sys.argv[1], sys.argv[2], QUICK), np.random.default_rng(0)
    while True:
        try:
            work.do(random_act(work.state, rng))
        except PrunusError:
            continue
        print(len(work.acts), flush=True)
"""


@pytest.mark.parametrize("after", [1, 7, 20])
@pytest.mark.slow
def test_a_killed_server_loses_at_most_the_last_act(
    scan_file: Path, folder: Path, after: int
) -> None:
    code = textwrap.dedent(WORKER)
    told = 0
    with child("-c", code, str(scan_file), str(folder)) as worker:
        assert worker.stdout is not None
        while told < after:
            told = int(worker.stdout.readline())
        worker.send_signal(signal.SIGKILL)
        rest = worker.stdout.read().split()
    told = int(rest[-1]) if rest else told
    with Work.open(scan_file, folder, QUICK) as work:
        assert work.read_only is None, "the lock of the dead is taken over"
        assert told <= len(work.acts) <= told + 1
        written = read_skeleton(folder / "corrected.json")
        assert same(written, work.state.draft.skeleton().moved(work.state.scan.to_input))


def test_a_torn_last_line_costs_the_last_act(scan_file: Path, folder: Path, opened: Work) -> None:
    kept = opened.do(Relabel(opened.state.draft.nodes[-1], Label.SIDE_BRANCH))
    opened.do(SetStatus(True))
    opened.close()
    journal = folder / "journal.jsonl"
    journal.write_bytes(journal.read_bytes()[:-9])
    with Work.open(scan_file, folder) as again:
        assert len(again.acts) == 1
        assert same_state(again.state, kept)
        again.do(SetStatus(True))
    assert [line.number for line in read_journal(journal).lines] == [2, 3]  # type: ignore[union-attr]


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ('{"at": "2026-01-01", "act": "remove_edge", "node": 99999}', ":2: node 99999"),
        ('{"at": "2026-01-01", "act": "remove_edge", "node": -1}', ":2: remove_edge.node"),
        ("nonsense", ":2: not JSON"),
    ],
)
def test_a_corrupt_journal_is_told_and_left_alone(
    scan_file: Path, folder: Path, opened: Work, text: str, says: str
) -> None:
    opened.close()
    journal = folder / "journal.jsonl"
    journal.write_text(journal.read_text() + text + "\n")
    before = {path: path.read_bytes() for path in folder.iterdir()}
    with pytest.raises(PrunusError) as raised:
        Work.open(scan_file, folder)
    assert str(raised.value).startswith(f"{journal}{says}")
    assert {path: path.read_bytes() for path in folder.iterdir()} == before


def changed_head(folder: Path, **values: object) -> None:
    journal = folder / "journal.jsonl"
    head, *lines = journal.read_text().splitlines()
    journal.write_text("\n".join([json.dumps(json.loads(head) | values), *lines]) + "\n")


def test_other_superpoints_are_told(scan_file: Path, folder: Path, opened: Work) -> None:
    opened.do(RemoveEdge(opened.state.draft.nodes[-1]))
    opened.close()
    changed_head(folder, superpoints="0123", version_of_prunus="0.0.7")
    with pytest.raises(PrunusError, match=r":1: was made on other superpoints, by prunus 0\.0\.7"):
        Work.open(scan_file, folder)
    assert (folder / "corrected.json").exists()


def test_a_journal_without_acts_is_begun_anew(scan_file: Path, folder: Path, opened: Work) -> None:
    opened.close()
    changed_head(folder, superpoints="0123")
    with Work.open(scan_file, folder, QUICK) as again:
        again.do(SetStatus(True))
    Work.open(scan_file, folder).close()


def test_acts_that_give_something_else_are_told(
    scan_file: Path, folder: Path, opened: Work
) -> None:
    one, other = opened.state.draft.nodes[-2:]
    opened.do(RemoveEdge(one))
    opened.close()
    journal = folder / "journal.jsonl"
    journal.write_text(journal.read_text().replace(f'"node": {one}', f'"node": {other}'))
    with Work.open(scan_file, folder) as again:
        assert again.acts == [RemoveEdge(other)]
        assert again.notes[-1].startswith(f"{journal}:2: gives another tree")


def test_the_settings_are_those_of_the_journal(scan_file: Path, folder: Path, opened: Work) -> None:
    opened.do(SetStatus(True))
    opened.close()
    with Work.open(scan_file, folder, Settings(frame="optical", seed=5)) as again:
        assert again.settings == QUICK
        assert "frame, unit, parameters and seed are those of its journal" in again.notes


def test_another_cloud_under_the_name_is_told(
    scan_file: Path, folder: Path, opened: Work, tmp_path: Path
) -> None:
    opened.do(SetStatus(True))
    opened.close()
    other = tmp_path / scan_file.name
    write_cloud(other, read_cloud(scan_file).xyz[:-1])
    with pytest.raises(PrunusError, match="is another file than its journal was made on"):
        Work.open(other, folder)
    with Work.open(scan_file, folder) as again:
        assert again.read_only is None, "whoever could not open it does not lock it"


@pytest.fixture
def told(scan_file: Path, folder: Path, tmp_path: Path) -> Path:
    """A skeleton in a folder of its own, its cloud in the folder above."""
    Work.open(scan_file, folder, QUICK).close()
    place = tmp_path / "out" / "clean" / "skeleton.json"
    place.parent.mkdir(parents=True)
    shutil.move(folder / "skeleton.json", place)
    shutil.copy(scan_file, tmp_path / "out")
    return place


def test_a_skeleton_is_opened_with_its_cloud(told: Path, tmp_path: Path) -> None:
    with Work.open(told, tmp_path / "again", QUICK) as work:
        expected = read_skeleton(told)
        assert same(work.state.result.skeleton, expected)
        assert not [note for note in work.notes if "another skeleton" in note]


def test_a_skeleton_with_a_base_by_hand_is_found_again(
    scan_file: Path, tmp_path: Path, machine: State
) -> None:
    from prunus.batch.run import Options, Task, do

    up = machine.draft.after[machine.draft.after[machine.draft.base][0]][0]
    base = outside(machine, machine.draft.places[up])
    do(Task(scan_file, tmp_path / "out"), Options(base=base, frame="z-up", report=False))
    shutil.copy(scan_file, tmp_path / "out")
    with Work.open(tmp_path / "out" / "skeleton.json", tmp_path / "work", QUICK) as work:
        assert same(work.state.result.skeleton, read_skeleton(tmp_path / "out" / "skeleton.json"))
        work.do(SetStatus(True))
        first = work.state
    with Work.open(tmp_path / "out" / "skeleton.json", tmp_path / "work", QUICK) as again:
        assert same_state(again.state, first)


def test_a_skeleton_that_the_chain_does_not_give_is_told(told: Path, tmp_path: Path) -> None:
    record = json.loads(told.read_text())
    record["label"][-1], record["branch"] = "trunk", None
    told.write_text(json.dumps(record))
    with Work.open(told, tmp_path / "again", QUICK) as work:
        assert "the chain gives another skeleton than the file has" in " ".join(work.notes)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"input": None}, "does not say of which cloud it is"),
        ({"input": {"file": "gone.ply", "sha256": "0", "points": 1}}, "gone.ply: not found in"),
        ({"input": {"file": "clean.ply", "sha256": "0", "points": 1}}, "its sha256 is another"),
        ({"input": {"file": "../clean.ply", "sha256": "0", "points": 1}}, "the name of a file"),
        ({"params": {"x": 1}}, "params: x: unknown parameter"),
    ],
)
def test_a_skeleton_without_its_cloud_says_what_to_do(
    told: Path, tmp_path: Path, change: dict[str, object], says: str
) -> None:
    told.write_text(json.dumps(json.loads(told.read_text()) | change))
    with pytest.raises(PrunusError, match=says):
        Work.open(told, tmp_path / "again", QUICK)


def test_a_skeleton_of_nothing_known_is_told(tmp_path: Path, machine: State) -> None:
    write_skeleton(tmp_path / "bare.json", machine.result.skeleton)
    with pytest.raises(PrunusError, match="does not say of which cloud"):
        Work.open(tmp_path / "bare.json", tmp_path / "again")


def test_a_full_disk_leaves_the_journal_as_it_was(
    opened: Work, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = (folder / "journal.jsonl").read_bytes()

    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    act: Act = SetStatus(True)
    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", full)
        with pytest.raises(PrunusError, match="cannot be written"):
            opened.do(act)
    assert (folder / "journal.jsonl").read_bytes() == before
    assert not opened.state.done
    assert opened.do(act).done


def test_no_more_states_are_held_than_are_needed_to_go_back(opened: Work) -> None:
    for k in range(memory.KEPT + 20):
        opened.do(SetStatus(k % 2 == 0))
    assert len(opened._history._states) <= memory.KEPT + 2
    while opened.undo() is not None:
        pass
    assert not opened.state.done
