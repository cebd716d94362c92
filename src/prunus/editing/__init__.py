"""Edits to a labelled skeleton by hand: acts as values, and the rules asked after each."""

from prunus.editing.acts import (
    Act,
    AddPath,
    Mark,
    MoveBase,
    PickBase,
    Reattach,
    Rebuild,
    Relabel,
    RemoveBranch,
    RemoveEdge,
    Search,
    SetStatus,
    Together,
    from_json,
    to_json,
)
from prunus.editing.draft import Draft
from prunus.editing.refused import Refused
from prunus.editing.state import State
from prunus.editing.where import Box, Brush, Class, Component, Lasso, Slab
from prunus.editing.words import branch_names

__all__ = [
    "Act",
    "AddPath",
    "Box",
    "Brush",
    "Class",
    "Component",
    "Draft",
    "Lasso",
    "Mark",
    "MoveBase",
    "PickBase",
    "Reattach",
    "Rebuild",
    "Refused",
    "Relabel",
    "RemoveBranch",
    "RemoveEdge",
    "Search",
    "SetStatus",
    "Slab",
    "State",
    "Together",
    "branch_names",
    "from_json",
    "to_json",
]
