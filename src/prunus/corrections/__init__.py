"""A skeleton corrected by hand: acts as values, rules asked after each, all of it written down."""

from prunus.corrections.acts import (
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
from prunus.corrections.draft import Draft
from prunus.corrections.journal import Status, status_of
from prunus.corrections.refused import Refused
from prunus.corrections.sources import Settings
from prunus.corrections.state import State
from prunus.corrections.where import Box, Brush, Class, Component, Lasso, Slab
from prunus.corrections.words import branch_names
from prunus.corrections.work import Work

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
    "Settings",
    "Slab",
    "State",
    "Status",
    "Together",
    "Work",
    "branch_names",
    "from_json",
    "status_of",
    "to_json",
]
