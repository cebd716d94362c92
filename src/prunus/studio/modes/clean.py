"""Clean: say which points are the tree, and build it again from those."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import viser

from prunus.editing import Brush, Class, Component, Lasso, Mark, PickBase, Rebuild, Slab
from prunus.editing.where import Shape
from prunus.errors import PrunusError
from prunus.model import Kind
from prunus.studio.camera import Eye
from prunus.studio.modes.history import History
from prunus.studio.modes.mode import Key, Mode, freed, put, watch
from prunus.studio.picking import Ray, first_point
from prunus.studio.scene import PICKED, Wishes
from prunus.studio.words import block, kinds, quiet

KINDS = tuple(kind.name.lower() for kind in Kind)
TOOLS = {
    "box": "Hold Shift and drag a box over the points.",
    "lasso": "Click the corners around the points; Enter closes it, Escape gives it up.",
    "brush": "Click points; all around each is marked.",
    "base": "Click where the trunk of the tree meets the ground; then build it again.",
    "piece": "Click a point; all that hangs together with it is marked.",
}
"""What a click is asked for, by tool."""
POINT_REACH = 8.0
"""A point is meant so many pixels beside it."""
SHEET = 0.5
"""The corners of a lasso are drawn so far before the eye, metres."""


class Clean(Mode):
    """Marks points of the scan; the scan itself stays as it is."""

    name = "Clean"

    def build(self) -> None:
        """Make the controls."""
        gui = self.desk.gui
        self.history = History(self.desk)
        self.corners: list[tuple[float, float]] = []
        self.eye: Eye | None = None
        self.before: Wishes | None = None
        self.kind = freed(gui.add_dropdown("Mark as", KINDS, initial_value=KINDS[Kind.STRAY],
                                           hint="target: the tree. Keys 0 to 6"))  # fmt: skip
        self.tool = freed(gui.add_dropdown("With", tuple(TOOLS)))
        watch(self.tool, lambda value: self._ask())
        self.asked = gui.add_html(block(quiet(TOOLS["box"])))
        self.radius = gui.add_slider("Brush [cm]", 1, 30, 1, 5)
        self.gap = gui.add_slider("Gap [cm]", 1, 30, 1, 5, hint="A piece goes on over such gaps")
        self.whole = freed(gui.add_dropdown("All of", KINDS, initial_value=KINDS[Kind.GROUND]))
        marks = gui.add_button_group("", ("mark all of it",))
        marks.on_click(lambda event: self.desk.try_to(self._whole))
        again = gui.add_button(
            "Build the tree again",
            hint="From the points that are target "
            "now; what was corrected of the skeleton gives way",
        )
        again.on_click(lambda event: self.desk.try_to(self._rebuild))
        self.history.build()
        self.counts = gui.add_html("")

    def keys(self) -> list[Key]:
        """The kinds, the lasso, undo."""
        kinds = [
            Key(key=str(n), text=f"Mark as {word}", does=self._takes(word))
            for n, word in enumerate(KINDS)
        ]
        return [
            *kinds,
            Key(key="enter", text="Close the lasso", does=self._close),
            Key(key="escape", text="Give the lasso up", does=self._ask),
            *self.history.keys(),
        ]

    def enter(self) -> None:
        """All points are shown, each class in its colour; Shift drags a box."""
        self.before = self.desk.show.wishes
        self.desk.show.want(replace(self.before, others=True, colour="class"))
        self.desk.client.scene.on_rect_select(modifier="shift")(self._boxed)

    def leave(self) -> None:
        """What was shown before is shown again."""
        self.desk.client.scene.remove_rect_select_callback("all")
        if self.before is not None:
            self.desk.show.want(self.before)
        self.before = None
        self.redraw()
        self._ask()

    def redraw(self) -> None:
        """How many points each kind has, and the base that was picked for the next time."""
        if self.desk.picture is not None:
            self.counts.content = kinds(self.desk.picture)
        state = self.desk.tree.state
        picked = state is not None and state.base is not None and self.before is not None
        base = state.base[None] if picked else np.zeros((0, 3))  # type: ignore[union-attr,index]
        self.desk.painter.places("base", base, PICKED, 0.02)

    def clicked(self, ray: Ray, screen: tuple[float, float]) -> None:
        """What the tool asked for."""
        tool = self.tool.value
        if tool == "lasso":
            self._corner(screen)
        elif tool == "brush":
            self._mark(Brush((self._point(ray),), self.radius.value / 100))
        elif tool == "piece":
            self._mark(Component(self._point(ray), self.gap.value / 100))
        elif tool == "base":
            self.desk.act(PickBase(self._point(ray)))

    def _point(self, ray: Ray) -> tuple[float, float, float]:
        """The point of the scan at a ray, in the frame of the file."""
        picture = self.desk.picture
        if picture is None:
            raise PrunusError("the tree is not open yet")
        xyz = picture.scan.xyz[self.desk.show.wishes.slab.holds(picture.scan.xyz)]
        best = first_point(ray, xyz, POINT_REACH)
        if best is None:
            raise PrunusError("no point is there; click nearer to one")
        x, y, z = picture.scan.to_input.apply(xyz[best]).tolist()
        return x, y, z

    def _boxed(self, event: viser.SceneRectSelectEvent) -> None:
        (left, top), (right, bottom) = event.screen_min, event.screen_max
        corners = ((left, top), (right, top), (right, bottom), (left, bottom))
        self.desk.try_to(lambda: self._around(corners, self.desk.eye))

    def _corner(self, screen: tuple[float, float]) -> None:
        """One corner more; a lasso is drawn in one image, so the camera must not move."""
        eye = self.desk.eye
        if self.corners and eye != self.eye:
            self.corners = []
            self.desk.say("Lasso", "the view has moved: the lasso begins anew")
        self.eye = eye
        self.corners.append(screen)
        sheet = eye.sheet(np.array([*self.corners, self.corners[0]]), SHEET)
        self.desk.painter.places("corners", sheet[:-1], PICKED, 0.0015)
        self.desk.painter.mark("lasso", np.stack([sheet[:-1], sheet[1:]], axis=1), PICKED, 3.0)

    def _close(self) -> None:
        if len(self.corners) < 3 or self.eye is None:
            raise PrunusError("a lasso has at least three corners")
        corners, eye = tuple(self.corners), self.eye
        self._ask()
        self._around(corners, eye)

    def _around(self, corners: tuple[tuple[float, float], ...], eye: Eye) -> None:
        """Mark what is seen inside a polygon."""
        picture = self.desk.picture
        if picture is None:
            raise PrunusError("the tree is not open yet")
        back = picture.scan.to_input.inverse()
        motion = np.eye(4)
        motion[:3, :3], motion[:3, 3] = back.rotation, back.translation
        rows = [tuple(row) for row in (eye.projection @ motion).tolist()]
        polygon = tuple((float(u), float(v)) for u, v in corners)
        self._mark(Lasso(polygon, tuple(rows), self._slab()))  # type: ignore[arg-type]

    def _slab(self) -> Slab | None:
        """The slab in the frame of the file: depth is a direction there."""
        slab, picture = self.desk.show.wishes.slab, self.desk.picture
        if picture is None or not np.isfinite([slab.near, slab.far]).all():
            return None
        depth = picture.scan.to_input.rotation[:, 1]
        shift = float(depth @ picture.scan.to_input.translation)
        x, y, z = depth.tolist()
        return Slab((x, y, z), slab.near + shift, slab.far + shift)

    def _whole(self) -> None:
        self._mark(Class(Kind[self.whole.value.upper()]))

    def _mark(self, where: Shape) -> None:
        self.desk.act(Mark(where, Kind[self.kind.value.upper()]))

    def _rebuild(self) -> None:
        self.desk.say("Build", "the chain runs again on the points of the tree; what was corrected "
                      "of the skeleton gives way, undo brings it back")  # fmt: skip
        self.desk.act(Rebuild())

    def _takes(self, word: str) -> Callable[[], None]:
        def take() -> None:
            put(self.kind, word)

        return take

    def _ask(self) -> None:
        """Begin anew with the tool that is chosen."""
        self.corners, self.eye = [], None
        self.asked.content = block(quiet(TOOLS[self.tool.value]))
        self.desk.painter.places("corners", np.zeros((0, 3)), PICKED)
        self.desk.painter.mark("lasso", np.zeros((0, 2, 3)), PICKED, 3.0)
