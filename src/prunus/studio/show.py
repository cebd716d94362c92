"""The controls of what is shown: layers, points, the slab, the views."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import viser

from prunus.studio.camera import VIEWS
from prunus.studio.modes.mode import Key, freed, put, watch
from prunus.studio.picture import MOST_POINTS, Picture, Slab
from prunus.studio.scene import LAYERS, Wishes, without

if TYPE_CHECKING:
    from prunus.studio.desk import Desk

COLOURS = ("grey", "depth", "rgb", "class")
CLOSE = "close"
"""The view of what is picked."""


class Show:
    """Holds the wishes of one person, and the controls that change them."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        self.wishes = Wishes()
        self.lent: frozenset[str] = frozenset()
        self.boxes: dict[str, viser.GuiCheckboxHandle] = {}

    def build(self) -> None:
        """Make the controls."""
        gui = self.desk.gui
        views = gui.add_button_group("View", (*VIEWS, CLOSE), hint="Keys F, R, T, C")
        views.on_click(lambda event: self.desk.try_to(lambda: self._view(event.target.value)))
        with gui.add_folder("Show"):
            self._points()
            self.slab = gui.add_multi_slider(
                "Depth", -1.0, 1.0, 0.01, (-1.0, 1.0), hint="Hides what is nearer and farther"
            )
            watch(self.slab, self._cut)
            for layer in LAYERS[1:7]:
                self._box(layer)
        with gui.add_folder("Evidence", expand_by_default=False):
            for layer in LAYERS[7:]:
                self._box(layer)

    @property
    def shown(self) -> Wishes:
        """What is wished for, with the layers that the tool in hand needs."""
        return replace(self.wishes, layers=self.wishes.layers | self.lent)

    def lend(self, *layers: str) -> None:
        """Show layers as long as a tool needs them; none takes them back."""
        if self.lent != frozenset(layers):
            self.lent = frozenset(layers)
            self.desk.paint()

    def keys(self) -> list[Key]:
        """The views."""
        desk = self.desk
        return [
            Key(key="F", text="Front view", does=lambda: desk.view("front")),
            Key(key="R", text="View from the right", does=lambda: desk.view("side")),
            Key(key="T", text="View from the top", does=lambda: desk.view("top")),
            Key(key="C", text="Close view of what is picked", does=desk.close_up),
        ]

    def fit(self, picture: Picture) -> None:
        """The slab over the depth of another tree."""
        low = float(picture.scan.xyz[:, 1].min()) - 0.01
        high = float(picture.scan.xyz[:, 1].max()) + 0.01
        self.wishes = replace(self.wishes, slab=Slab())
        self.slab.min, self.slab.max = round(low, 2), round(high, 2)
        put(self.slab, (self.slab.min, self.slab.max))

    def want(self, wishes: Wishes) -> None:
        """Show this from now on, and let the controls say so; the slab stays."""
        self.wishes = replace(wishes, slab=self.wishes.slab)
        put(self.others, wishes.others)
        put(self.colour, wishes.colour)
        for layer, box in self.boxes.items():
            put(box, layer in wishes.layers)

    def _view(self, name: str) -> None:
        if name == CLOSE:
            self.desk.close_up()
        else:
            self.desk.view(name)

    def _points(self) -> None:
        gui = self.desk.gui
        self._box("points")
        self.colour = freed(
            gui.add_dropdown("Colour", COLOURS, hint="depth: red in front, blue behind")
        )
        watch(self.colour, lambda value: self._wish(colour=value))
        self.others = freed(
            gui.add_checkbox("others", False, hint="What is not the tree: ground, posts")
        )
        watch(self.others, lambda value: self._wish(others=value))
        share = gui.add_slider("Share [%]", 1, 100, 1, 100, hint=f"Of at most {MOST_POINTS:,}")
        watch(share, lambda value: self._wish(share=value / 100))
        size = gui.add_slider("Size [mm]", 1, 15, 1, 3)
        watch(size, lambda value: self._wish(size=value / 1000))

    def _box(self, layer: str) -> None:
        shown = layer in self.wishes.layers
        box = freed(self.desk.gui.add_checkbox(layer.replace("_", " "), shown))
        self.boxes[layer] = box
        watch(box, lambda shown: self._switch(layer, shown))

    def _switch(self, layer: str, shown: bool) -> None:
        with self.desk.lock:
            self.wishes = without(self.wishes, layer, shown)
            self.desk.paint()

    def _wish(self, **change: object) -> None:
        with self.desk.lock:
            self.wishes = replace(self.wishes, **change)  # type: ignore[arg-type]
            self.desk.paint_points()

    def _cut(self, ends: tuple[float, ...]) -> None:
        with self.desk.lock:
            if tuple(self.slab.value) != tuple(ends):
                return
            whole = ends[0] <= self.slab.min and ends[1] >= self.slab.max
            self.wishes = replace(self.wishes, slab=Slab() if whole else Slab(ends[0], ends[1]))
            self.desk.paint()
