"""Correct: remove, add, relabel, reattach, move the base, search again."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from prunus.editing import (
    Act,
    AddPath,
    MoveBase,
    Reattach,
    Relabel,
    RemoveBranch,
    RemoveEdge,
    Search,
)
from prunus.errors import PrunusError
from prunus.model import Label
from prunus.studio.modes.history import History
from prunus.studio.modes.mode import Key, Mode, freed, put, watch
from prunus.studio.modes.path import Path, Scope
from prunus.studio.picking import Ray
from prunus.studio.scene import PICKED
from prunus.studio.words import block, quiet, word_of

WORDS = tuple(word_of(label) for label in Label)
REACHES = {"B": "branch", "I": "edge", "O": "onward", "U": "until"}
"""How far a relabelling goes, by key; W, A, S, D, Q and E fly the camera."""
ASKS = {
    "pick": "Click a branch, then choose what to do with it.",
    "path": "Click a node of the tree, then each stop of the new path; Enter ends it, Escape "
    "gives it up.",
    "reattach": "Click the node of the tree from which the picked edge is to come.",
    "base": "Click where the trunk meets the ground.",
}
"""What a click is asked for, by tool."""


class Correct(Mode):
    """A click picks an edge, or is what the chosen tool asks for."""

    name = "Correct"

    def build(self) -> None:
        """Make the controls."""
        gui = self.desk.gui
        self.tool, self.path, self.history = "pick", Path(), History(self.desk)
        self.asked = gui.add_html(block(quiet(ASKS["pick"])))
        self._group("Remove", {"edge": self._remove_edge, "branch": self._remove_branch},
                    "Delete, Shift Delete")  # fmt: skip
        self.reach = freed(gui.add_dropdown(
            "Relabel the", tuple(REACHES.values()),
            hint="onward: from here to the tip; until: from its start to here. Keys B, I, O, U",
        ))  # fmt: skip
        self._group("as", {word: self._labels(Label(n)) for n, word in enumerate(WORDS)},
                    "Keys 1 to 4")  # fmt: skip
        self._group("Path", {"new": self._begin, "end": self._end, "give up": self._stop},
                    "P, Enter, Escape")  # fmt: skip
        self.label = freed(gui.add_dropdown("Path is", WORDS, initial_value=WORDS[-1]))
        self.routed = freed(
            gui.add_checkbox("routed", True, hint="Along the likeliest candidate edges")
        )
        watch(self.routed, lambda value: self.redraw())
        self.snaps = freed(
            gui.add_checkbox("at superpoints", True, hint="Else at points of the scan")
        )
        self._group("Move", {"edge": self._reattach, "base": self._base}, "N, M")
        self._group("Search", {"again, holding this": self._search})
        self.history.build()

    def keys(self) -> list[Key]:
        """All tools have one."""
        labels = [
            Key(key=str(n + 1), text=f"Relabel as {word}", does=self._labels(Label(n)))
            for n, word in enumerate(WORDS)
        ]
        return [
            Key(key="delete", text="Remove the edge", does=self._remove_edge),
            Key(key="delete", text="Remove the branch", does=self._remove_branch, modifier="shift"),
            *labels,
            *[
                Key(key=key, text=f"Relabel the {reach}", does=self._takes(reach))
                for key, reach in REACHES.items()
            ],
            Key(key="P", text="New path", does=self._begin),
            Key(key="enter", text="End the path", does=self._end),
            Key(key="escape", text="Give up", does=self._stop),
            Key(key="N", text="Move the edge to another node", does=self._reattach),
            Key(key="M", text="Move the base", does=self._base),
            *self.history.keys(),
        ]

    def acted(self) -> None:
        """The path that was refused is in the tree, in another way."""
        self._stop()

    def leave(self) -> None:
        """A path that was not ended is given up."""
        self._stop()

    def redraw(self) -> None:
        """The stops of the path, which the tree may have come to hold, and the way over them."""
        xyz = way = np.zeros((0, 3))
        if self.desk.picture is not None and self.path.stops:
            scope = self._scope()
            xyz, way = self.path.places(scope), self.path.way(scope, self.routed.value)
        self.desk.painter.places("stops", xyz, PICKED)
        self.desk.painter.mark("stops-line", np.stack([way[:-1], way[1:]], axis=1), PICKED, 3.0)

    def clicked(self, ray: Ray, screen: tuple[float, float]) -> None:
        """What the tool asked for."""
        if self.tool == "path":
            self._stop_at(ray)
        elif self.tool == "reattach":
            self._onto(ray)
        elif self.tool == "base":
            self._base_at(ray)
        else:
            self.desk.pick(ray)

    def _scope(self) -> Scope:
        picture, state = self.desk.picture, self.desk.tree.state
        if picture is None or state is None:
            raise PrunusError("the tree is not open yet")
        return Scope(picture, state, self.desk.show.wishes.slab)

    def _picked(self) -> int:
        if self.desk.picture is None or not self.desk.picture.row(self.desk.picked):
            raise PrunusError("no edge is picked; click one first")
        assert self.desk.picked is not None
        return self.desk.picked

    def _remove_edge(self) -> None:
        self.desk.act(RemoveEdge(self._picked()))

    def _remove_branch(self) -> None:
        self.desk.act(RemoveBranch(self._picked()))

    def _labels(self, label: Label) -> Callable[[], None]:
        def relabel() -> None:
            reach: Any = self.reach.value
            self.desk.act(Relabel(self._picked(), label, reach))

        return relabel

    def _takes(self, reach: str) -> Callable[[], None]:
        return lambda: put(self.reach, reach)

    def _search(self) -> None:
        self.desk.act(Search())

    def _begin(self) -> None:
        self.path = Path()
        self._ask("path")

    def _stop_at(self, ray: Ray) -> None:
        scope = self._scope()
        self.path.add(scope, ray, self.snaps.value)
        if len(self.path.stops) == 1 and isinstance(self.path.stops[0], int):
            put(self.label, word_of(scope.suggested(self.path.stops[0])))
        self.redraw()

    def _end(self) -> None:
        stops = tuple(self.path.stops)
        if len(stops) < 2:
            raise PrunusError("a path has at least two stops")
        label = Label(WORDS.index(self.label.value))
        if self.desk.act(AddPath(stops, label, self.routed.value)):
            self._stop()

    def _stop(self) -> None:
        self.path = Path()
        self._ask("pick")

    def _reattach(self) -> None:
        self._picked()
        self._ask("reattach")

    def _onto(self, ray: Ray) -> None:
        node = self._scope().tree_node(ray)
        if node is not None:
            self._once(Reattach(self._picked(), node))

    def _base(self) -> None:
        self._ask("base")

    def _base_at(self, ray: Ray) -> None:
        scope = self._scope()
        node = scope.tree_node(ray)
        node = scope.superpoint(ray) if node is None else node
        low = scope.picture.box[0]
        self._once(MoveBase(scope.free_point(ray, low) if node is None else node))

    def _once(self, act: Act) -> None:
        """An act after which clicks pick again."""
        self._ask("pick")
        self.desk.act(act)

    def _ask(self, tool: str) -> None:
        self.tool = tool
        self.asked.content = block(quiet(ASKS[tool]))
        self.desk.show.lend(*(["superpoints"] if tool in ("path", "base") else []))
        self.redraw()

    def _group(
        self, label: str, does: dict[str, Callable[[], None]], hint: str | None = None
    ) -> None:
        group = self.desk.gui.add_button_group(label, tuple(does), hint=hint)
        group.on_click(lambda event: self.desk.try_to(does[event.target.value]))
