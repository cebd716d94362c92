"""What a person does to a tree, as values.

An act in JSON is an object with its name under `act` (`{"act": "remove_edge", "node": 17}`), a
choice of points one with its name under `shape`. Nodes are numbered as in a `Draft`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import Field, PlainSerializer, PlainValidator

from prunus.editing.where import Where
from prunus.editing.wire import Checked, KindWord, LabelWord, Node, Place, read, told
from prunus.errors import PrunusError

Reach = Literal["edge", "branch", "onward", "until"]
"""One edge, the branch that holds it, from it to the branch's tip, or from its start until it."""


@dataclass(frozen=True)
class AddPath(Checked):
    """A path from a node of the tree over further stops, none of them in the tree.

    `routed`: between two superpoints along the cheapest candidate edges, else straight.
    """

    stops: Annotated[tuple[Place, ...], Field(min_length=2)]
    label: LabelWord
    routed: bool = False


@dataclass(frozen=True)
class RemoveEdge(Checked):
    """The edge into a node goes, with what hangs beyond it."""

    node: Node


@dataclass(frozen=True)
class RemoveBranch(Checked):
    """The branch that holds the edge into a node goes, with what hangs on it."""

    node: Node


@dataclass(frozen=True)
class Relabel(Checked):
    """Another label for the edge into a node, its branch, or the part of it after or before.

    The label that is there already confirms it: the search keeps it.
    """

    node: Node
    label: LabelWord
    reach: Reach = "edge"


@dataclass(frozen=True)
class Reattach(Checked):
    """The edge into a node now comes from another node of the tree."""

    node: Node
    onto: Node


@dataclass(frozen=True)
class MoveBase(Checked):
    """The tree starts at this place.

    From a node of the trunk, what is below it goes; elsewhere the trunk is led to the place from
    its nearest higher node. The next `Rebuild` starts there too.
    """

    place: Place


@dataclass(frozen=True)
class PickBase(Checked):
    """The next `Rebuild` starts at this place; the skeleton stays as it is until then."""

    place: Place


Step = AddPath | RemoveEdge | RemoveBranch | Relabel | Reattach | MoveBase
"""An act on the skeleton alone."""
STEPS: tuple[type[Step], ...] = (
    AddPath, RemoveEdge, RemoveBranch, Relabel, Reattach, MoveBase,
)  # fmt: skip


def _step(value: Any) -> Step:
    return read(value, "act", STEPS)


def _told(step: Step) -> dict[str, Any]:
    return told(step, "act")


@dataclass(frozen=True)
class Together(Checked):
    """Several acts on the skeleton as one: only after the last need the tree be legal."""

    acts: Annotated[
        tuple[Annotated[Step, PlainValidator(_step), PlainSerializer(_told)], ...],
        Field(min_length=1),
    ]


@dataclass(frozen=True)
class Mark(Checked):
    """The chosen points of the scan are of this kind; the next `Rebuild` goes by it."""

    where: Where
    kind: KindWord


@dataclass(frozen=True)
class Rebuild(Checked):
    """The chain again on the points marked as the target, from the base where one was picked.

    Where nothing was marked by hand, a raw scan is taken apart anew, for the tree at that base.
    The acts on the skeleton before it are superseded.
    """


@dataclass(frozen=True)
class Search(Checked):
    """The search again, holding what was corrected since the last `Rebuild`."""


@dataclass(frozen=True)
class SetStatus(Checked):
    """The tree is done, or in work again."""

    done: bool


Act = Step | Together | PickBase | Mark | Rebuild | Search | SetStatus
ACTS: tuple[type[Act], ...] = (*STEPS, Together, PickBase, Mark, Rebuild, Search, SetStatus)


def to_json(act: Act) -> dict[str, Any]:
    """The act as an object of JSON; PrunusError where a field is of a wrong type."""
    try:
        return told(act, "act")
    except ValueError as error:
        raise PrunusError(str(error)) from error


def from_json(values: Any) -> Act:
    """The act in an object of JSON; PrunusError naming the field, what was found and expected."""
    try:
        return read(values, "act", ACTS)
    except ValueError as error:
        raise PrunusError(str(error)) from error
