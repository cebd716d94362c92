"""An act that was refused: the rule in words, the place, and the repairs as buttons."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

import numpy as np
import viser

from prunus.editing import Act, Refused
from prunus.studio.words import block

if TYPE_CHECKING:
    from prunus.studio.desk import Desk

PLACE = (255, 120, 0)


class Refusal:
    """Tells of one refused act until the next act."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        self.repairs: list[viser.GuiButtonHandle] = []

    def build(self) -> None:
        """A place on the panel, empty at first."""
        self.folder = self.desk.gui.add_folder("Refused", visible=False)
        with self.folder:
            self.text = self.desk.gui.add_html("")

    def tell(self, refused: Refused) -> None:
        """Show why, where, and what would do instead."""
        self.clear()
        offers = [f"{n}. {escape(text)}" for n, (text, _) in enumerate(refused.repairs, 1)]
        told = ["instead:", *offers] if offers else []
        self.text.content = block(escape(str(refused).replace("_", " ")), *told)
        self.folder.visible = True
        self.desk.painter.places("refused", refused.places, PLACE, 0.02)
        with self.folder:
            self.repairs = [
                self._offer(f"Do {number} instead", act)
                for number, (_, act) in enumerate(refused.repairs, 1)
            ]

    def clear(self) -> None:
        """Nothing is refused any more."""
        for button in self.repairs:
            button.remove()
        self.repairs = []
        self.folder.visible = False
        self.desk.painter.places("refused", np.zeros((0, 3)), PLACE)

    def _do(self, act: Act) -> None:
        if self.desk.act(act):
            self.desk.mode.acted()

    def _offer(self, name: str, act: Act) -> viser.GuiButtonHandle:
        button = self.desk.gui.add_button(name, color="orange")
        button.on_click(lambda event: self._do(act))
        return button
