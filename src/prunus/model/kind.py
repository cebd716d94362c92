"""What a point of a raw scan belongs to."""

from __future__ import annotations

from enum import IntEnum


class Kind(IntEnum):
    """The target, another tree of its row, the arm of the V behind, or no tree at all."""

    TARGET = 0
    NEIGHBOUR = 1
    BEHIND = 2
    GROUND = 3
    POST = 4
    WIRE = 5
    STRAY = 6
