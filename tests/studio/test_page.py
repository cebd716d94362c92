"""What a person does on the page, done by a browser."""

from __future__ import annotations

import signal
import subprocess
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from prunus.editing import AddPath
from prunus.io.skeletons.plans import read_plan
from prunus.io.skeletons.skeleton_file import read_skeleton
from prunus.model import Label
from prunus.params import Parameters
from prunus.session import Settings
from prunus.studio.modes import cuts
from prunus.studio.modes.correct import REACHES
from prunus.studio.modes.mode import put
from prunus.studio.planned import planned
from prunus.studio.shelf import Item
from prunus.studio.tree import Tree
from tests.processes.children import prunus
from tests.studio.conftest import Remote, Visit, new_page, soon, until

Opened = Callable[..., Visit]
pytestmark = pytest.mark.slow  # each opens a browser


def free_superpoint(visit: Visit) -> int:
    """A superpoint that is not in the tree, seen apart from all others."""
    graph, eye = visit.desk.picture.graph, visit.desk.eye
    image = eye.image(graph.xyz) * [eye.width, eye.height]
    apart = np.linalg.norm(image[:, None] - image[None], axis=2)
    np.fill_diagonal(apart, np.inf)
    lonely = np.argsort(-apart.min(axis=1)).tolist()
    inside = ((image > 20) & (image < [eye.width - 20, eye.height - 20])).all(axis=1)
    return int(next(n for n in lonely if n not in visit.nodes and inside[n]))


def test_a_tree_is_opened_turned_corrected_and_found_again(opened: Opened, tmp_path: Path) -> None:
    visit = opened()
    visit.reads("edit distance")
    first = visit.nodes

    # Rotate: the camera goes round the tree.
    was = visit.desk.eye.position
    visit.page.mouse.move(550, 300)
    visit.page.mouse.down()
    visit.page.mouse.move(650, 320, steps=4)
    visit.page.mouse.up()
    until(lambda: np.linalg.norm(visit.desk.eye.position - was) > 0.1, "another camera")
    visit.page.keyboard.press("f")
    until(lambda: np.allclose(visit.desk.eye.position, was, atol=0.01), "the front view")

    # Remove a branch, take that back, do it again.
    visit.press("Correct")
    visit.reads("Click a branch, then")
    side = visit.a_branch(Label.SIDE_BRANCH)
    visit.click_edge(side)
    visit.page.keyboard.press("Shift+Delete")
    until(lambda: side not in visit.nodes, "the branch gone")
    visit.page.keyboard.press("Control+z")
    until(lambda: visit.nodes == first, "the branch back")
    visit.page.keyboard.press("Control+y")
    until(lambda: side not in visit.nodes, "the branch gone again")

    # Relabel what the rules let be relabelled.
    leader = visit.a_branch(Label.LEADER)
    visit.click_edge(leader)
    visit.page.keyboard.press("2")
    visit.reads("instead:")
    corrected = tmp_path / "oak" / "corrected.json"
    assert len(read_skeleton(corrected)) == len(visit.nodes) < len(first)

    # Reload: all is there.
    left = visit.nodes
    visit.page.reload()
    visit.see_tree()
    assert visit.nodes == left
    visit.reads("1 act, all saved")


def test_a_path_is_added_stop_by_stop(opened: Opened) -> None:
    visit = opened()
    visit.press("Correct")
    visit.reads("Click a branch, then")
    first = visit.nodes
    draft = visit.desk.tree.state.draft
    visit.page.keyboard.press("p")
    visit.reads("Click a node of the tree, then")
    begin = visit.a_branch(Label.LEADER)
    visit.click(draft.places[begin])
    until(lambda: visit.desk.mode.path.stops == [begin], "the first stop")
    end = free_superpoint(visit)
    visit.click(draft.places[end])
    until(lambda: visit.desk.mode.path.stops == [begin, end], "the second stop")
    mode = visit.desk.mode
    routed = mode.path.way(mode._scope(), routed=True)
    until(lambda: lines_of(visit, "stops-line") == len(routed) - 1, "the routed way")
    visit.page.get_by_label("routed").uncheck()
    until(lambda: lines_of(visit, "stops-line") == 1, "the straight way")
    visit.press("end")
    until(lambda: end in visit.nodes, "the path")
    assert set(first) < set(visit.nodes)
    assert isinstance(visit.desk.tree.work.acts[-1], AddPath)


def test_a_choice_gives_the_keys_back(opened: Opened) -> None:
    visit = opened()
    visit.press("Correct")
    visit.reads("Click a branch, then")
    visit.page.get_by_label("Relabel the").first.click()
    visit.page.get_by_role("option", name="onward").click()
    until(lambda: visit.desk.mode.reach.value == "onward", "onward")

    def heard() -> bool:
        visit.page.get_by_label("at superpoints").click()
        visit.page.wait_for_timeout(500)
        visit.page.keyboard.press("u")
        return bool(soon(lambda: visit.desk.mode.reach.value == "until"))

    until(heard, "a key that is heard after a choice")


def lines_of(visit: Visit, mark: str) -> int:
    """How many lines a mark in the scene has."""
    drawn = visit.desk.painter.drawn.get(f"/mark/{mark}")
    return 0 if drawn is None else len(drawn.places) // (2 * 3 * 4)


def test_a_path_that_is_drawn_in_another_way_is_at_its_end(opened: Opened) -> None:
    visit = opened()
    visit.press("Correct")
    visit.reads("Click a branch, then")
    draft = visit.desk.tree.state.draft
    visit.page.keyboard.press("p")
    visit.reads("Click a node of the tree, then")
    begin, end = visit.a_branch(Label.LEADER), free_superpoint(visit)
    visit.click(draft.places[begin])
    until(lambda: visit.desk.mode.path.stops == [begin], "the first stop")
    visit.click(draft.places[end])
    until(lambda: visit.desk.mode.path.stops == [begin, end], "the second stop")
    visit.page.get_by_label("routed").uncheck()
    put(visit.desk.mode.label, "trunk")
    visit.press("end")
    visit.reads("instead:")
    visit.press("Do 1 instead")
    until(lambda: end in visit.nodes, "the path")
    until(lambda: visit.desk.mode.tool == "pick" and not visit.desk.mode.path.stops, "its end")


def test_the_close_view_turns_about_what_is_picked(opened: Opened) -> None:
    visit = opened()
    visit.press("Correct")
    visit.reads("Click a branch, then")
    node = visit.a_branch(Label.LEADER)
    visit.click_edge(node)
    skeleton, row = visit.picture.skeleton, visit.picture.row(node)
    middle = skeleton.xyz[[row, skeleton.parent[row]]].mean(axis=0)
    visit.page.keyboard.press("c")
    until(lambda: np.allclose(visit.desk.client.camera.look_at, middle, atol=0.01), "it in view")
    until(lambda: np.linalg.norm(visit.eye.position - middle) < 2, "an eye that is near")


def test_how_far_a_relabelling_goes_is_told_by_keys(opened: Opened) -> None:
    visit = opened()
    visit.press("Correct")
    visit.reads("Click a branch, then")
    visit.click_edge(visit.a_branch(Label.LEADER))
    for key, reach in REACHES.items():
        visit.page.keyboard.press(key.lower())
        until(lambda reach=reach: visit.desk.mode.reach.value == reach, reach)


def test_points_are_marked_by_a_box_and_the_file_stays(
    opened: Opened, orchard: Path, tmp_path: Path
) -> None:
    scan = (orchard / "oak.ply").read_bytes()
    visit = opened()
    visit.press("Clean")
    visit.reads("Hold Shift")
    before = visit.desk.tree.state.kind

    def kind_is_as_before() -> bool:
        return bool((visit.desk.tree.state.kind == before).all())

    def boxed() -> bool:
        drag_a_box(visit.page)
        return bool(soon(lambda: not kind_is_as_before()))

    def undone() -> bool:
        visit.page.keyboard.press("Control+z")
        return bool(soon(kind_is_as_before))

    until(boxed, "points marked: the first box may come before the page listens")
    assert (tmp_path / "oak" / "mask.ply").exists()
    until(undone, "points as before")
    assert (orchard / "oak.ply").read_bytes() == scan


def drag_a_box(page: Any) -> None:
    """Hold Shift and drag a box over the crown."""
    page.keyboard.down("Shift")
    page.mouse.move(300, 170)
    page.mouse.down()
    page.mouse.move(850, 320, steps=4)
    page.mouse.up()
    page.keyboard.up("Shift")


def test_edges_are_labelled_one_key_each(opened: Opened, tmp_path: Path) -> None:
    visit = opened(settings=Settings(params=Parameters.paper()))
    visit.press("Label")
    visit.reads("0 of")
    asked = [visit.desk.mode.queue.edge]
    for key, count in (("v", 1), ("x", 2), ("3", 3)):
        visit.page.keyboard.press(key)
        visit.reads(f"{count} of")
        until(lambda: visit.desk.mode.queue.edge != asked[-1], "the next edge")
        asked.append(visit.desk.mode.queue.edge)
    assert len(set(asked)) == 4
    unsure = np.abs(visit.desk.mode.queue.graph.confidence[asked] - 0.5)
    assert (np.diff(unsure) >= 0).all()
    assert (tmp_path / "oak" / "labels.jsonl").read_text().count("\n") == 4


def test_cuts_are_planned_looked_at_and_saved(
    opened: Opened, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made: list[Any] = []

    def counted(state: Any) -> Any:
        made.append(state)
        return planned(state)

    monkeypatch.setattr(cuts, "planned", counted)
    visit = opened()
    visit.press("Cuts")
    plan = until(lambda: visit.desk.mode.planned, "a plan").plan
    visit.reads("for a person to look at first")
    assert "/mark/ways" in visit.desk.painter.drawn

    # Step through those that a person looks at first, then click one from the front.
    looked = [number for number, cut in enumerate(plan.cuts) if cut.needs_review]
    for number in looked[:2]:
        visit.page.keyboard.press("n")
        until(lambda number=number: visit.desk.mode.at == number, "the next cut")
        visit.reads(plan.cuts[number].reasons[0])
    visit.page.keyboard.press("b")
    until(lambda: visit.desk.mode.at == looked[0], "the cut before")
    visit.page.keyboard.press("f")
    last = max(range(len(plan.cuts)), key=lambda n: plan.cuts[n].point[2])
    visit.click_until(np.array(plan.cuts[last].point), lambda: visit.desk.mode.at == last)
    visit.reads(plan.cuts[last].because)

    # Saved, and told to be old once the tree is another; no act but the mode makes a plan.
    visit.press("Save plan")
    visit.reads("saved in plan.json")
    assert len(read_plan(tmp_path / "oak" / "plan.json").cuts) == len(plan.cuts)
    visit.press("Correct")
    visit.reads("Click a branch, then")
    assert "/mark/ways" not in visit.desk.painter.drawn
    visit.press("Cuts")
    visit.reads("saved in plan.json")
    visit.press("Correct")
    visit.reads("Click a branch, then")
    side = visit.a_branch(Label.SIDE_BRANCH)
    visit.click_edge(side)
    visit.page.keyboard.press("Shift+Delete")
    until(lambda: side not in visit.nodes, "the branch gone")
    assert len(made) == 1
    visit.press("Cuts")
    visit.reads("is of the tree as it was before")
    assert len(made) == 2


def test_the_mode_stays_on_with_another_tree(opened: Opened) -> None:
    visit = opened("", settings=Settings(params=Parameters.paper()))
    visit.page.goto(visit.studio.url)
    visit.reads("cannot be opened")
    visit.press("Label")
    visit.reads("\N{BLACK CIRCLE} Label")
    for _ in range(2):
        number = visit.desk.number
        visit.page.keyboard.press("PageDown")
        until(lambda number=number: visit.desk.number != number, "the next tree")
    visit.see_tree()
    visit.reads("0 of")


def test_a_broken_file_is_told_and_the_page_lives_on(opened: Opened) -> None:
    visit = opened("")
    visit.page.goto(visit.studio.url)
    visit.reads("cannot be opened")
    for _ in range(2):
        number = visit.desk.number
        visit.page.keyboard.press("PageDown")
        until(lambda number=number: visit.desk.number != number, "the next tree")
    visit.see_tree()
    visit.reads("edit distance")
    assert visit.page.locator("img[src=x]").count() == 0


def test_nothing_is_sent_before_the_token(opened: Opened) -> None:
    visit = opened(token="open sesame")
    received = list[bytes]()

    def keep(frame: object) -> None:
        received.append(frame if isinstance(frame, bytes) else str(frame).encode())

    visit.page.on("websocket", lambda socket: socket.on("framereceived", keep))
    visit.page.goto(visit.studio.url)
    visit.page.get_by_role("button", name="Open", exact=True).wait_for()
    assert not visit.studio.desks
    assert received and not any(b"oak" in frame for frame in received)
    visit.page.get_by_role("textbox").last.fill("open barley")
    visit.press("Open")
    visit.reads("This is not the token.")
    assert not visit.studio.desks
    visit.page.get_by_role("textbox").last.fill("open sesame")
    visit.press("Open")
    visit.see_tree()


def test_the_second_studio_on_a_folder_only_reads(opened: Opened, tmp_path: Path) -> None:
    one, other = opened(), opened()
    one.reads("0 acts, all saved")
    other.reads("read only")
    other.press("Correct")
    side = other.a_branch(Label.SIDE_BRANCH)
    other.click_edge(side)
    other.press("branch")
    other.reads("This cannot be done")
    assert side in other.nodes


def test_a_killed_server_loses_nothing_that_was_shown(
    browser: Any, orchard: Path, tmp_path: Path
) -> None:
    scan, work = orchard / "oak.ply", tmp_path / "work"
    tree = Tree(Item("oak", scan, tmp_path / "aside"), Settings())
    tree.watch(lambda: None)
    until(lambda: tree.state, "the chain")
    picture = tree.picture()
    tree.close()
    with running(scan, work) as (server, url), a_page(browser) as page:
        visit = Remote(page, picture)
        visit.come(url)
        visit.press("Correct")
        for count, node in enumerate(visit.branches_apart(Label.SIDE_BRANCH)[:2], 1):
            visit.click_edge(node)
            page.keyboard.press("Shift+Delete")
            visit.reads(f"{count} act")
        saved = (work / "oak" / "corrected.json").read_bytes()
        visit.press("undo")
        server.kill()
        server.wait()
    with running(scan, work) as (server, url), a_page(browser) as page:
        Remote(page, picture).come(url)
        assert (work / "oak" / "lock.json").exists()
        server.terminate()
        assert server.wait(60) == 128 + signal.SIGTERM
    assert not (work / "oak" / "lock.json").exists()
    acts = (work / "oak" / "journal.jsonl").read_text().splitlines()[1:]
    assert len(acts) in (2, 3)
    again = (work / "oak" / "corrected.json").read_bytes()
    assert (again == saved) == (len(acts) == 2)


@contextmanager
def running(scan: Path, work: Path) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """The command as a person runs it, and where it says the page is."""
    with prunus("studio", scan, "-o", work, "--port", 0, "--no-open") as server:
        yield server, server.stdout.readline().split()[-1]


@contextmanager
def a_page(browser: Any) -> Iterator[Any]:
    page = new_page(browser)
    yield page
    page.close()
