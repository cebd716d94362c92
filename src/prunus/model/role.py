"""What wood does in a tree, whatever the training system."""

from __future__ import annotations

from enum import IntEnum


class Role(IntEnum):
    """The role of a piece of wood; a grammar gives each the name it has in its training system.

    In a UFO orchard: trunk, support, leader, side branch; spurs, shoots on trunk and supports.
    """

    STEM = 0
    FRAMEWORK = 1
    FRUITING_UNIT = 2
    LATERAL = 3
    SPUR_OR_SHOOT = 4
    NO_WOOD = 5
