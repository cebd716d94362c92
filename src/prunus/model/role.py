"""What wood does in a tree, whatever the training system."""

from __future__ import annotations

from enum import IntEnum

import numpy as np

from prunus.model.arrays import Floats
from prunus.model.skeleton import Label


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


def label_chances(role: Floats) -> Floats:
    """The probability (M, 4) of each label, of roles (M, 6); a spur counts as side branch."""
    chance = role[:, : len(Label)].copy()
    chance[:, Label.SIDE_BRANCH] += role[:, Role.SPUR_OR_SHOOT]
    return np.asarray(chance / np.maximum(chance.sum(axis=1, keepdims=True), 1e-9))
