"""Look: a click tells about an edge and its branch."""

from __future__ import annotations

from prunus.studio.modes.mode import Mode
from prunus.studio.words import block, quiet


class Look(Mode):
    """Nothing can be changed here."""

    name = "Look"

    def build(self) -> None:
        """A word on how to look."""
        self.desk.gui.add_html(
            block(quiet("Drag turns, wheel zooms, right drag moves. Click a branch to read of it."))
        )
