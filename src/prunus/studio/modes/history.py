"""Undo and redo, as every mode that acts has them."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from prunus.studio.modes.mode import Key

if TYPE_CHECKING:
    from prunus.studio.desk import Desk


class History:
    """The buttons and keys that take acts back and do them again."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk

    def build(self) -> None:
        """Make the buttons."""
        group = self.desk.gui.add_button_group("History", ("undo", "redo"), hint="Ctrl Z, Ctrl Y")
        group.on_click(lambda event: self.desk.try_to(self._does(event.target.value)))

    def keys(self) -> list[Key]:
        """Ctrl Z, and Ctrl Y or Ctrl Shift Z."""
        return [
            Key(key="Z", text="Undo", does=self.undo, modifier="cmd/ctrl"),
            Key(key="Y", text="Redo", does=self.redo, modifier="cmd/ctrl"),
            Key(key="Z", text="Redo", does=self.redo, modifier="cmd/ctrl+shift"),
        ]

    def undo(self) -> None:
        """Take the last act back."""
        if not self.desk.tree.undo():
            self.desk.say("Undo", "there is nothing to take back")

    def redo(self) -> None:
        """Do again what was taken back last."""
        if not self.desk.tree.redo():
            self.desk.say("Redo", "there is nothing to do again")

    def _does(self, name: str) -> Callable[[], None]:
        return {"undo": self.undo, "redo": self.redo}[name]
