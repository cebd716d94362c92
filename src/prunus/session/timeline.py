"""What was done, undone and done again, line by line of the journal."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

from prunus.editing.acts import Act

Move = Act | Literal["undo", "redo"]


@dataclass(frozen=True, kw_only=True)
class Line:
    """A further line: its number in the file, when, what, and a digest of what it gave."""

    number: int
    at: str
    move: Move
    gives: str | None


@dataclass(frozen=True)
class Timeline:
    """Lines with acts, one after another; those from `position` on were undone."""

    lines: tuple[Line, ...] = ()
    position: int = 0

    @classmethod
    def of(cls, lines: Iterable[Line]) -> Timeline:
        """The timeline at the end of a journal's lines."""
        timeline = cls()
        for line in lines:
            timeline = timeline.after(line)
        return timeline

    @property
    def acts(self) -> list[Act]:
        """The acts, those that were undone at the end."""
        return [line.move for line in self.lines if not isinstance(line.move, str)]

    @property
    def standing(self) -> list[Act]:
        """The acts that were not undone."""
        return self.acts[: self.position]

    def can(self, move: Move) -> bool:
        """Whether there is something to undo, or to redo."""
        if move == "undo":
            return self.position > 0
        return move != "redo" or self.position < len(self.lines)

    def after(self, line: Line) -> Timeline:
        """The timeline one line later; a new act forgets those undone."""
        if line.move == "undo":
            return Timeline(self.lines, self.position - 1)
        if line.move == "redo":
            return Timeline(self.lines, self.position + 1)
        return Timeline((*self.lines[: self.position], line), self.position + 1)
