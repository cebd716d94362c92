"""What all modes share."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from prunus.studio.picking import Ray

if TYPE_CHECKING:
    from prunus.studio.desk import Desk


@dataclass(frozen=True, kw_only=True)
class Key:
    """A key with what it does; `modifier` such as 'shift' or 'cmd/ctrl'."""

    key: Any
    text: str
    does: Callable[[], None]
    modifier: Any = None


def put(control: Any, value: object) -> None:
    """Set what a control shows; mypy takes viser's setters for read-only."""
    control.value = value


def watch(control: Any, does: Callable[[Any], None]) -> None:
    """Call with the value of a control when the person, not the program, has changed it."""

    @control.on_update  # type: ignore[untyped-decorator]
    def _(event: Any) -> None:
        if event.client is not None:
            does(event.target.value)


AWAY = 0.1
"""A control is away so long, seconds, that the page has seen it."""


def freed(control: Any) -> Any:
    """The same control, which gives the keyboard back to the page once a person has chosen.

    A field that has the cursor keeps all keys to itself; one that was away has it no more.
    """

    @control.on_update  # type: ignore[untyped-decorator]
    def _(event: Any) -> None:
        if event.client is not None:
            control.visible = False
            event.client.flush()
            time.sleep(AWAY)
            control.visible = True

    return control


class Mode:
    """A way to work on the tree of a desk; this one does nothing."""

    name = ""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk

    def build(self) -> None:
        """Make the controls, once, in a folder of their own."""

    def keys(self) -> list[Key]:
        """The keys that hold while the mode is chosen."""
        return []

    def enter(self) -> None:
        """The mode was chosen."""

    def leave(self) -> None:
        """Another mode was chosen, or another tree."""

    def acted(self) -> None:
        """What was refused has been done in another way."""

    def redraw(self) -> None:
        """The tree has changed."""

    def clicked(self, ray: Ray, screen: tuple[float, float]) -> None:
        """A click in the scene, at `screen`: 0 to 1 from left and top. Picks an edge."""
        self.desk.pick(ray)
