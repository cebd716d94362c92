"""The page of one browser: its panel, its scene, and the tree that it looks at."""

from __future__ import annotations

import threading
from collections.abc import Callable
from math import tan

import numpy as np
import viser
from viser.transforms import SO3

from prunus.editing import Act, Refused
from prunus.errors import PrunusError
from prunus.model import Floats
from prunus.studio.camera import Eye, standing
from prunus.studio.folder import FolderPanel
from prunus.studio.header import header, notes
from prunus.studio.modes import MODES
from prunus.studio.modes.mode import Key, Mode
from prunus.studio.modes.refusal import Refusal
from prunus.studio.picking import Ray, nearest_edge
from prunus.studio.picture import Picture
from prunus.studio.scene import BESIDE, PICKED, Painter
from prunus.studio.show import Show
from prunus.studio.tree import Tree
from prunus.studio.words import block, card, legend, quiet

REACH = 12.0
"""An edge is picked so many pixels beside it."""
CLOSE = 0.18
"""The close view shows so many metres around an edge."""
TOLD, CONTROLS = 240, 350
"""Width of the panel on the left, which tells, and of that on the right, pixels."""
ON = "\N{BLACK CIRCLE}"
"""Marks the mode that is on."""


class Desk:
    """All that belongs to one browser. Its callbacks take its lock, one after another."""

    def __init__(self, client: viser.ClientHandle, trees: list[Tree], first: int) -> None:
        self.client = client
        self.gui = client.gui
        self.trees = trees
        self.number = first
        self.lock = threading.RLock()
        self.painter = Painter(client.scene)
        self.show = Show(self)
        self.modes: list[Mode] = [mode(self) for mode in MODES]
        self.mode = self.modes[0]
        self.picture: Picture | None = None
        self.picked: int | None = None
        self.framed = False
        self.viewed: tuple[str, Floats, tuple[int, int]] | None = None
        self.closed = False
        self.commands: list[viser.CommandHandle] = []
        with self.lock:
            self._build()
            self.client.scene.on_click()(self._clicked)
            self.client.camera.on_update(lambda camera: self._moved())
            self.choose(self.modes[0].name)
            self.tree.watch(self.refresh)

    @property
    def tree(self) -> Tree:
        """The tree that is looked at."""
        return self.trees[self.number]

    def open(self, number: int) -> None:
        """Look at another tree of the list."""
        with self.lock:
            if number == self.number or not 0 <= number < len(self.trees):
                return
            self.refusal.clear()
            self.mode.leave()
            self.tree.leave(self.refresh)
            self.painter.clear()
            self.number, self.picture, self.picked, self.framed = number, None, None, False
            self.tree.watch(self.refresh)
            self.mode.enter()
            self.redraw()

    def close(self) -> None:
        """The browser is gone."""
        with self.lock:
            self.closed = True
            self.tree.leave(self.refresh)

    def choose(self, name: str) -> None:
        """Work in another mode; what it says is seen once its keys are heard."""
        with self.lock:
            self.refusal.clear()
            self.mode.leave()
            self.mode = next(mode for mode in self.modes if mode.name == name)
            self._hold_keys()
            self.mode.enter()
            self._offer_modes()
            for mode, folder in zip(self.modes, self.folders, strict=True):
                folder.visible = mode is self.mode
            self.redraw()

    def refresh(self) -> None:
        """Draw again what the tree has become; from any thread, and without waiting."""
        threading.Thread(target=self.redraw, daemon=True).start()

    def redraw(self) -> None:
        """Draw what the tree is now."""
        with self.lock:
            if not self.closed:
                with self.client.atomic():
                    self._redraw()

    def _redraw(self) -> None:
        self.header.content, self.notes.content = header(self.tree), notes(self.tree)
        self.folder.tell()
        before, self.picture = self.picture, self.tree.picture()
        if self.picture is None:
            return
        if before is None or before.scan is not self.picture.scan:
            self.show.fit(self.picture)
        self.paint()
        self._frame()
        self.mode.redraw()

    def paint(self) -> None:
        """All layers, the legend and what is picked."""
        if self.picture is not None:
            self.painter.paint(self.picture, self.show.shown)
            self.legend.content = legend(self.picture)
            self._paint_picked()

    def paint_points(self) -> None:
        """The points only."""
        if self.picture is not None:
            self.painter.points(self.picture, self.show.shown)

    def view(self, name: str) -> None:
        """Look at the tree from the front, the side or the top."""
        if self.picture is None:
            return
        eye = self.eye
        size = eye.width, eye.height
        position, aim = standing(name, *self.picture.box, eye.width / max(eye.height, 1))
        self.viewed = name, position, size
        with self.client.atomic():
            self.client.camera.position = position
            self.client.camera.look_at = aim

    def _moved(self) -> None:
        """The camera was moved; view again as before where only the window has changed."""
        with self.lock:
            if self.closed:
                return
            eye = self.eye
            self.painter.stand_at(eye.position)
            if self.viewed is None:
                return
            name, position, size = self.viewed
            stands = np.allclose(eye.position, position, atol=1e-3)
            if stands and size != (eye.width, eye.height):
                self.view(name)

    def close_up(self) -> None:
        """Show the picked edge from near by; from now on the view turns about it."""
        row = None if self.picture is None else self.picture.row(self.picked)
        if self.picture is None or self.picture.skeleton is None or not row:
            raise PrunusError("no edge is picked; click one first")
        skeleton = self.picture.skeleton
        ends = skeleton.xyz[[int(skeleton.parent[row]), row]]
        self.frame(ends.min(axis=0) - CLOSE, ends.max(axis=0) + CLOSE)

    def frame(self, low: Floats, high: Floats) -> None:
        """Show a box (3,), (3,) from where the eye looks now."""
        eye = self.eye
        half = float(np.linalg.norm(high - low)) / 2
        aim, distance = (low + high) / 2, half / tan(eye.fov / 2)
        with self.client.atomic():
            self.client.camera.position = aim - distance * eye.rotation[:, 2]
            self.client.camera.look_at = aim

    @property
    def eye(self) -> Eye:
        """The camera of this browser."""
        camera = self.client.camera
        rotation = np.asarray(SO3(np.asarray(camera.wxyz)).as_matrix(), np.float64)
        return Eye(
            position=np.asarray(camera.position),
            rotation=rotation,
            fov=camera.fov,
            width=int(camera.image_width),
            height=int(camera.image_height),
        )

    def pick(self, ray: Ray) -> None:
        """Take the edge at a ray as the picked one; none where none is near."""
        if self.picture is None or self.picture.skeleton is None:
            return
        skeleton = self.picture.skeleton
        edge = nearest_edge(ray, skeleton.xyz[skeleton.edges], REACH)
        self.picked = None if edge is None else self.picture.nodes[edge + 1]
        self._paint_picked()
        self.mode.redraw()

    def act(self, act: Act) -> bool:
        """Do an act on the tree; whether it was done. A refusal is told with its repairs."""
        with self.lock:
            self.refusal.clear()
            try:
                self.tree.do(act)
            except Refused as refused:
                self.refusal.tell(refused)
                return False
            except PrunusError as error:
                self.say("This cannot be done", str(error), "orange")
                return False
            return True

    def say(self, title: str, text: str, colour: str = "blue") -> None:
        """A note that goes by itself."""
        self.client.add_notification(title, text, auto_close_seconds=8.0, color=colour)  # type: ignore[call-overload]

    def try_to(self, work: Callable[[], object]) -> None:
        """Do something that may not be possible; what is wrong is told on the page."""
        with self.lock:
            try:
                work()
            except PrunusError as error:
                self.say("This cannot be done", str(error), "orange")

    def _clicked(self, event: viser.SceneClickEvent) -> None:
        with self.lock:
            direction = np.asarray(event.ray_direction)
            ray = Ray(
                np.asarray(event.ray_origin), direction / np.linalg.norm(direction), self.eye.pixel
            )
            self.try_to(lambda: self.mode.clicked(ray, event.screen_pos))

    def _paint_picked(self) -> None:
        picture = self.picture
        row = None if picture is None else picture.row(self.picked)
        if picture is None or picture.skeleton is None or not row:
            self.painter.halo(np.zeros((0, 2, 3)), BESIDE, 14)
            self.painter.mark("edge", np.zeros((0, 2, 3)), PICKED, 7)
            self.card.content = block(quiet("Click a branch to read of it.")) if picture else ""
            return
        xyz, rows = picture.skeleton.xyz, picture.branches[int(picture.owner[row])].rows
        run = np.stack([xyz[rows[:-1]], xyz[rows[1:]]], axis=1)
        self.painter.halo(run, BESIDE, 14)
        self.painter.mark("edge", xyz[[[picture.skeleton.parent[row], row]]], PICKED, 7)
        self.card.content = card(picture, row)

    def _frame(self) -> None:
        """Show all of the tree when it is first seen, and again when the chain has found it."""
        if self.picture is not None and not self.framed:
            self.framed = self.picture.skeleton is not None
            self.view("front")

    def _build(self) -> None:
        self.gui.main_panel.dock_right()
        self.gui.main_panel.set_width(CONTROLS)
        self.folder = FolderPanel(self)
        self.folder.build()
        self.offered = self.gui.add_button_group("Mode", ("",))
        self.folders = []
        for mode in self.modes:
            folder = self.gui.add_folder(mode.name)
            self.folders.append(folder)
            with folder:
                mode.build()
        self.show.build()
        self._build_told()

    def _offer_modes(self) -> None:
        """The modes as buttons, the one that is on marked; none of them holds the keyboard."""
        names = {f"{ON} {mode.name}" if mode is self.mode else mode.name: mode.name
                 for mode in self.modes}  # fmt: skip
        order = self.offered.order
        self.offered.remove()
        self.offered = self.gui.add_button_group("Mode", tuple(names), order=order)
        self.offered.on_click(lambda event: self.choose(names[event.target.value]))

    def _build_told(self) -> None:
        """The panel on the left: how the tree stands, what was refused, what is picked."""
        beside = self.gui.add_panel()
        with beside.add_tab("Tree"):
            self.header = self.gui.add_html(header(self.tree))
            self.refusal = Refusal(self)
            self.refusal.build()
            self.card = self.gui.add_html("")
            self.legend = self.gui.add_html("")
            self.notes = self.gui.add_html("")
        beside.dock_left()
        beside.set_width(TOLD)

    def _hold_keys(self) -> None:
        for command in self.commands:
            command.remove()
        keys: list[Key] = [*self.show.keys(), *self.folder.keys(), *self.mode.keys()]
        self.commands = [self._hold(key) for key in keys]

    def _hold(self, key: Key) -> viser.CommandHandle:
        command = self.gui.add_command(key.text, hotkey=key.key, modifier=key.modifier)
        command.on_trigger(lambda event: self.try_to(key.does))
        return command
