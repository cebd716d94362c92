"""The trees of the folder: which there are, how far each is, the next one."""

from __future__ import annotations

from typing import TYPE_CHECKING

from prunus.editing import SetStatus
from prunus.studio.modes.mode import Key, freed, put, watch

if TYPE_CHECKING:
    from prunus.studio.desk import Desk


class FolderPanel:
    """The list of trees on one desk; a name from the page is only looked up in the list."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk

    def build(self) -> None:
        """Make the controls; one tree alone has no list."""
        gui = self.desk.gui
        several = len(self.desk.trees) > 1
        self.list = freed(gui.add_dropdown("Tree", self._options(), visible=several))
        watch(self.list, self._chosen)
        put(self.list, self.list.options[self.desk.number])
        names = ("previous", "next", "done") if several else ("done",)
        hint = "Keys: page up, page down" if several else "Once more: in work again"
        steps = gui.add_button_group("Work", names, hint=hint)
        steps.on_click(lambda event: self._step(event.target.value))

    def keys(self) -> list[Key]:
        """One tree on, one back."""
        if len(self.desk.trees) == 1:
            return []
        return [
            Key(key="pageup", text="Previous tree", does=lambda: self._step("previous")),
            Key(key="pagedown", text="Next tree", does=lambda: self._step("next")),
        ]

    def tell(self) -> None:
        """How far each tree is, as it stands now."""
        options = self._options()
        if tuple(self.list.options) != options:
            self.list.options = options
        if self.list.value != options[self.desk.number]:
            put(self.list, options[self.desk.number])

    def _options(self) -> tuple[str, ...]:
        """A line a tree; numbered, so that no two are alike."""
        return tuple(
            f"{number}  {tree.item.name}  ({'broken' if tree.problem else tree.status})"
            for number, tree in enumerate(self.desk.trees, 1)
        )

    def _chosen(self, line: str) -> None:
        options = tuple(self.list.options)
        if line in options:
            self.desk.open(options.index(line))

    def _step(self, name: str) -> None:
        if name == "done":
            self.desk.try_to(self._done)
            return
        step = 1 if name == "next" else -1
        self.desk.open((self.desk.number + step) % len(self.desk.trees))

    def _done(self) -> None:
        state = self.desk.tree.state
        if state is not None:
            self.desk.tree.do(SetStatus(not state.done))
