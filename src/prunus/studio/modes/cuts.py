"""Cuts: the pruning plan of the tree as it is corrected so far, and what is doubtful about it."""

from __future__ import annotations

import threading
from dataclasses import replace

import numpy as np

from prunus.cuts import Cut
from prunus.editing import State
from prunus.errors import PrunusError
from prunus.io.skeletons.export import COLOURS
from prunus.model import Floats, Ints, Label
from prunus.report.cuts import BLADE, LOOK, SURE, WAY, cone, disc
from prunus.studio.modes.mode import Key, Mode, freed, watch
from prunus.studio.picking import Ray, nearest_point
from prunus.studio.picture import colour_of
from prunus.studio.planned import Planned, planned
from prunus.studio.scene import PICKED, WIDTHS, Wishes
from prunus.studio.words import block, cut_card, plan_card, quiet

AROUND = 0.30
"""So many metres around a cut are in view."""
REACH = 12.0
"""A cut is meant so many pixels beside it, and anywhere on its blade."""
NONE: Floats = np.zeros((0, 3))


class Cuts(Mode):
    """Plans when it is chosen and when the tree has changed meanwhile; nothing is changed here."""

    name = "Cuts"

    def build(self) -> None:
        """Make the controls."""
        gui = self.desk.gui
        self.before: Wishes | None = None
        self.state: State | None = None
        self.planned: Planned | None = None
        self.at: int | None = None
        self.tree: object = None
        self.problem = ""
        self.text = gui.add_html("")
        steps = gui.add_button_group("Look at", ("back", "next"), hint="B, N")
        steps.on_click(lambda event: self.desk.try_to(lambda: self._step(event.target.value)))
        self.every = freed(
            gui.add_checkbox("every cut", False, hint="Else those for a person first")
        )
        watch(self.every, lambda value: self._tell())
        self.ways = freed(gui.add_checkbox("ways to them", True, hint="In which a tool comes"))
        watch(self.ways, lambda value: self._paint())
        self.card = gui.add_html("")
        save = gui.add_button("Save plan", hint="As plan.json beside the corrected skeleton")
        save.on_click(lambda event: self.desk.try_to(self._save))
        self.file = gui.add_html("")

    def keys(self) -> list[Key]:
        """One cut on, one back."""
        return [
            Key(key="N", text="Next cut", does=lambda: self._step("next")),
            Key(key="B", text="The cut before", does=lambda: self._step("back")),
        ]

    def enter(self) -> None:
        """The refined skeleton is shown in place of the other."""
        if self.tree is not self.desk.tree:
            self.state = self.planned = self.at = None
        self.tree = self.desk.tree
        self.before = self.desk.show.wishes
        rest = self.before.layers - {label.word for label in Label}
        self.desk.show.want(replace(self.before, layers=rest))

    def leave(self) -> None:
        """What was shown before is shown again."""
        if self.before is not None:
            self.desk.show.want(self.before)
        self.before = None
        self._paint()

    def redraw(self) -> None:
        """Plan anew where the tree is another than the one that was planned on."""
        state = self.desk.tree.state
        if self.before is None or state is None:
            return
        if self.state is None or not _alike(self.state, state):
            self.planned = self.at = None
            self.problem = ""
            threading.Thread(target=self._plan, args=(state,), daemon=True).start()
        self.state = state
        self._show()

    def clicked(self, ray: Ray, screen: tuple[float, float]) -> None:
        """The cut at the ray, else the edge there."""
        places = np.array([cut.point for cut in self._cuts]).reshape(-1, 3)
        best = nearest_point(ray, places, np.inf)
        if best is not None and _hit(ray, places[best]):
            self._choose(best)
        else:
            self.desk.pick(ray)

    @property
    def _cuts(self) -> tuple[Cut, ...]:
        return () if self.planned is None else self.planned.plan.cuts

    def _plan(self, state: State) -> None:
        """Plan, and show it if nothing has changed meanwhile."""
        found, problem = None, ""
        try:
            found = planned(state)
        except PrunusError as error:
            problem = str(error)
        with self.desk.lock:
            if self.state is not None and _alike(self.state, state) and not self.desk.closed:
                self.planned, self.problem = found, problem
                self._show()

    def _show(self) -> None:
        with self.desk.client.atomic():
            self._paint()
            self._tell()

    def _step(self, way: str) -> None:
        """Go to the next cut, or the one before, of those that are to be looked at."""
        asked = [n for n, cut in enumerate(self._cuts) if cut.needs_review or self.every.value]
        if not asked:
            raise PrunusError("no cut is for a person to look at first")
        at = -1 if self.at is None else self.at
        after, before = [n for n in asked if n > at], [n for n in asked if n < at]
        if way == "next":
            self._choose(after[0] if after else asked[0])
        else:
            self._choose(before[-1] if before else asked[-1])
        place = np.array(self._cuts[self.at or 0].point)
        self.desk.frame(place - AROUND, place + AROUND)

    def _choose(self, number: int) -> None:
        assert self.planned is not None
        self.at = number
        self.desk.picked = self.planned.node.get(self._cuts[number].branch)
        self.desk.paint()
        self._show()

    def _save(self) -> None:
        if self.planned is None:
            raise PrunusError("the plan is not made yet")
        self.desk.tree.save_plan(self.planned.plan)
        self._tell()

    def _tell(self) -> None:
        """The cuts in words."""
        if self.planned is None:
            self.text.content = block(quiet(self.problem or "planning ..."))
            self.card.content = self.file.content = ""
            return
        chosen = None if self.at is None else self._cuts[self.at]
        self.text.content = plan_card(self.planned.plan, chosen, self.every.value)
        self.card.content = "" if chosen is None else cut_card(chosen)
        self.file.content = block(quiet(self.desk.tree.told_of_plan(self.planned.plan)))

    def _paint(self) -> None:
        """The refined skeleton, the blades, the ways to them, and the cut that was chosen."""
        paint, cuts = self.desk.painter, self._cuts if self.before is not None else ()
        tree = None if self.before is None or self.planned is None else self.planned.skeleton
        for label in Label:
            rows = np.zeros(0, int) if tree is None else np.flatnonzero(tree.edges_with(label))
            ends = NONE if tree is None else tree.xyz[np.column_stack([tree.parent[rows], rows])]
            ends = ends.reshape(-1, 2, 3)
            name = f"/front/refined-{label.word}"
            paint.lines(name, ends, COLOURS[label], WIDTHS[label], Wishes(), True)
        for name, colour, look in (("sure", SURE, False), ("look", LOOK, True)):
            blades = [disc(cut) for cut in cuts if cut.needs_review == look]
            paint.mesh(f"/mark/blades-{name}", blades, colour_of(colour), 0.85)
            paint.mark(f"rims-{name}", _rims(blades), colour_of(colour), 3.0)
        shown = [cut for cut in cuts if cut.approach is not None and self.ways.value]
        paint.mesh("/mark/ways", [cone(cut) for cut in shown], colour_of(WAY), 0.25)
        chosen = [] if self.at is None or not cuts else [disc(cuts[self.at])]
        paint.mark("rim", _rims(chosen), PICKED, 6.0)


def _rims(blades: list[tuple[Floats, Ints]]) -> Floats:
    """The rims (E, 2, 3) of some blades, which light and shade leave as they are."""
    rims = [corners[faces[:, 1:]] for corners, faces in blades]
    return np.concatenate([np.zeros((0, 2, 3)), *rims])


def _alike(one: State, other: State) -> bool:
    """Whether the same plan is made on two states."""
    return one.draft is other.draft and one.kind is other.kind and one.held is other.held


def _hit(ray: Ray, place: Floats) -> bool:
    """Whether a ray meets the blade at a place (3,), or passes near to it as seen."""
    flat, depth = ray.seen(place[None])
    away = float(np.linalg.norm(flat[0]))
    return away <= max(REACH, BLADE / (float(depth[0]) * ray.pixel))
