"""How far the ground of a scan is from level. A camera looks down a little, or stands askew."""

from __future__ import annotations

import math

import numpy as np

from prunus.frames.ground import Ground
from prunus.model import Floats
from prunus.model.rotations import upright

MIN_TILT_DEG = 3.0
"""Ground that is tilted less is level."""
MIN_RISE_M = 0.06
"""So is ground that rises by less from end to end: a narrow strip tells little of its tilt."""


def levelling(ground: Ground) -> tuple[Floats, float]:
    """The least rotation (3, 3) that levels the ground of a scan in a house frame; its degrees.

    The slopes along the ground and across it are followed each for itself. No rotation, and no
    degrees, where it is level but for what cannot be told.
    """
    ways = np.column_stack([ground.along, np.cross(ground.up, ground.along)])
    slope = np.abs(np.arcsin(np.clip(ways[2], -1, 1)))
    rise = np.sin(slope) * [ground.length, ground.width]
    told = (np.degrees(slope) >= MIN_TILT_DEG) & (rise >= MIN_RISE_M)
    up = ground.up
    for way in ways.T[~told]:
        aside = np.array([way[0], way[1], 0.0]) / np.hypot(way[0], way[1])
        up = up - (up @ aside) * aside
    up = up / np.linalg.norm(up)
    tilt = math.degrees(math.acos(min(1.0, up[2])))
    return (upright(up), tilt) if told.any() else (np.eye(3), 0.0)
