"""A browser, a studio, and what a person does with them."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from prunus.io.clouds.cloud_file import write_cloud
from prunus.lab.simulate import simulate_scan
from prunus.model import Floats, Label
from prunus.session import Settings
from prunus.studio.camera import FOV, Eye, standing
from prunus.studio.picking import Ray, nearest_edge

CHROMIUM = Path("/usr/bin/chromium")
FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader",
         "--disable-quic", "--no-first-run", "--disable-background-networking",
         "--disable-component-update", "--disable-sync"]  # fmt: skip
PATIENCE = 180.0
"""Seconds after which nothing more is expected; a slow machine compiles the kernels meanwhile."""
PLAIN = Settings()


def until(holds: Callable[[], Any], what: str) -> Any:
    """What a condition gives once it holds; fails when it does not come to."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        found = holds()
        if found:
            return found
        time.sleep(0.02)
    pytest.fail(f"waited in vain: {what}")


def soon(holds: Callable[[], Any]) -> Any:
    """What a condition gives within a second or two, as things come to pass on a page."""
    end = time.monotonic() + 2.0
    while not (found := holds()) and time.monotonic() < end:
        time.sleep(0.02)
    return found


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    sync = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    pytest.importorskip("viser", reason="viser is not installed")
    if not CHROMIUM.exists():
        pytest.skip(f"no browser: {CHROMIUM} is missing")
    with sync.sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=str(CHROMIUM), args=FLAGS)
        yield opened
        opened.close()


def new_page(browser: Any) -> Any:
    """A page of the browser, as patient as all else here."""
    page = browser.new_page(viewport={"width": 1280, "height": 800})
    page.set_default_timeout(1000 * PATIENCE)
    return page


@pytest.fixture(scope="session")
def orchard(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a clean scan of a tree, a file that is none, and one with a hostile name."""
    folder = tmp_path_factory.mktemp("orchard")
    cloud = simulate_scan(3, "clean").target_cloud().sample(8000, np.random.default_rng(0))
    write_cloud(folder / "oak.ply", cloud.to_input.apply(cloud.xyz))
    (folder / "broken.ply").write_text("this is no cloud")
    (folder / "<img src=x onerror=alert(1)>.ply").write_text("neither is this")
    return folder


@dataclass
class Remote:
    """A browser page at a studio of which only the first picture is known, from the front."""

    page: Any
    picture: Any

    @property
    def eye(self) -> Eye:
        """The front view, as the page takes it by itself."""
        canvas = self.page.locator("canvas").first.bounding_box()
        width, height = int(canvas["width"]), int(canvas["height"])
        position, _ = standing("front", *self.picture.box, width / height)
        return Eye(
            position=position,
            rotation=np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]]),
            fov=FOV,
            width=width,
            height=height,
        )

    def come(self, url: str) -> None:
        """Open the page, and wait until the skeleton is drawn."""
        self.page.goto(url)
        self.reads("edit distance")

    def press(self, name: str) -> None:
        """Click a button."""
        self.page.get_by_role("button", name=name, exact=True).click()

    def reads(self, text: str) -> None:
        """Wait until a text stands on the page."""
        self.page.get_by_text(text, exact=False).first.wait_for(timeout=1000 * PATIENCE)

    def click(self, place: Floats) -> None:
        """Click a place (3,) of the house frame in the scene."""
        u, v = self.eye.image(place[None])[0]
        canvas = self.page.locator("canvas").first.bounding_box()
        self.page.mouse.click(canvas["x"] + u * canvas["width"], canvas["y"] + v * canvas["height"])

    def click_until(self, place: Floats, holds: Callable[[], Any]) -> None:
        """Click a place until that has led to something: the view may still be moving."""

        def clicked() -> bool:
            self.click(place)
            return bool(soon(holds))

        until(clicked, "what a click leads to")

    def click_edge(self, node: int) -> None:
        """Click the middle of the edge into a node, and wait until it is picked."""
        skeleton, row = self.picture.skeleton, self.picture.row(node)
        middle = skeleton.xyz[[row, skeleton.parent[row]]].mean(axis=0)
        self.click_until(middle, lambda: self.has_picked(node))

    def has_picked(self, node: int) -> bool:
        """Whether the page tells of the edge into a node."""
        return bool(self.page.get_by_text(re.compile(rf"^node {node}$")).count())

    def branches_apart(self, label: Label) -> list[int]:
        """A node of each branch of a label, where a click on its edge can mean no other."""
        skeleton, eye, found = self.picture.skeleton, self.eye, dict[int, int]()
        ends = skeleton.xyz[skeleton.edges]
        for row in np.flatnonzero(skeleton.edges_with(label)).tolist():
            way = ends[row - 1].mean(axis=0) - eye.position
            ray = Ray(eye.position, way / np.linalg.norm(way), eye.pixel)
            if nearest_edge(ray, np.delete(ends, row - 1, axis=0), 6.0) is None:
                found.setdefault(int(self.picture.owner[row]), int(self.picture.nodes[row]))
        assert found, f"no {label.word} stands apart from all others"
        return list(found.values())


class Visit(Remote):
    """A browser page at a studio of this process, and the desk that serves it."""

    def __init__(self, page: Any, studio: Any) -> None:
        self.page = page
        self.studio = studio

    @property
    def desk(self) -> Any:
        """The desk of the browser that came last."""
        return until(lambda: list(self.studio.desks.values()), "a desk")[-1]

    @property
    def picture(self) -> Any:
        """What is drawn."""
        return self.desk.picture

    @property
    def eye(self) -> Eye:
        """Where the eye of the browser stands."""
        eye: Eye = self.desk.eye
        return eye

    @property
    def nodes(self) -> list[int]:
        """The nodes of the tree as they are drawn."""
        return [] if self.picture is None else list(self.picture.nodes)

    def come(self, url: str = "") -> None:
        """Open the page, and wait until the skeleton is drawn."""
        before = set(self.studio.desks)
        self.page.goto(url or self.studio.url)
        until(lambda: set(self.studio.desks) - before, "a new desk")
        self.see_tree()

    def see_tree(self) -> None:
        """Wait until the skeleton is drawn and the camera stands still."""
        until(lambda: self.nodes, "the skeleton")
        seen = [np.zeros(3)]

        def still() -> bool:
            seen.append(self.eye.position)
            time.sleep(0.2)
            return bool(np.allclose(seen[-2], seen[-1]))

        until(still, "a camera that stands still")

    def has_picked(self, node: int) -> bool:
        """Whether the edge into a node is picked."""
        return bool(self.desk.picked == node)

    def a_branch(self, label: Label) -> int:
        """A node of one branch of a label."""
        return self.branches_apart(label)[0]


@pytest.fixture
def opened(browser: Any, orchard: Path, tmp_path: Path) -> Iterator[Callable[..., Visit]]:
    """Opens a studio on a file of the orchard, or on all of it, and a page at it."""
    from prunus.studio.server import Studio
    from prunus.studio.shelf import items_in

    ends: list[Callable[[], None]] = []

    def open_one(
        name: str = "oak.ply",
        token: str | None = None,
        work: Path = tmp_path,
        settings: Settings = PLAIN,
    ) -> Visit:
        items = items_in(orchard / name, work)
        studio = Studio(items, settings, "127.0.0.1", 0, token)
        page = new_page(browser)
        ends.extend([page.close, studio.stop])
        visit = Visit(page, studio)
        if token is None and name:
            visit.come()
        return visit

    yield open_one
    for end in ends:
        end()
