"""How far a scan is from its named frame: which way is up, and along which line the row runs.

A camera looks down a little, or stands askew. The ground says which way is up; the wood that lies
level (supports, wires) says where the row runs. Small differences are left alone.
"""

from __future__ import annotations

import math

import numpy as np

from prunus.model import Floats
from prunus.model.arrays import cubes
from prunus.model.rotations import turned, upright
from prunus.sensing.orient import Wood

STEEPEST = 25.0
"""Ground is tilted by so many degrees at most."""
TILTED = (3.0, 8.0)
"""The ground is followed when it is tilted by so many degrees along the row, and across it, where
little of it is in view and the feet of the row behind look like more."""
ASKEW = 6.0
"""The row is followed when it is so many degrees askew."""
FLAT = 0.025
"""The ground is a plane but for so many metres to either side."""
CUBE, ALONE = 0.04, 4
"""Points with fewer others in a cube of so many metres are strays."""
SQUARE = 0.10
"""The ground is looked for in the lowest points of squares of so many metres."""
GROUND = 0.23
"""The ground is so large a share of them, or it is not trusted."""
BELOW = 2.0
"""A point below the ground speaks against it as much as so many on it speak for it."""
TRIES, BROAD, FEW = 800, 0.05, 20
"""Planes through so many triples, spanning so many square metres; fewer points tell nothing."""
LOOKED_AT = 200_000
"""Of so many points."""
LEVEL = 0.35
"""Wood is level when it rises less than so many metres a metre."""
BESIDE = math.radians(12)
"""Wood runs along the row within so many radians, about."""
ALIKE = 0.4
"""So large a share of the level wood runs along the row, or it is not trusted."""


def find_turn(xyz: Floats, wood: Wood, rng: np.random.Generator) -> tuple[Floats, list[str]]:
    """The rotation (3, 3) that sets a scan in a named house frame right; what was turned.

    xyz (P, 3) are its points, and `wood` its local wood, in that frame.
    """
    turn, notes = np.eye(3), list[str]()
    xyz = xyz[:: max(1, len(xyz) // LOOKED_AT)]
    up = ground_normal(xyz, rng)
    followed = np.zeros(2) if up is None else np.where(_tilts(up) >= TILTED, up[:2], 0.0)
    if followed.any():
        up = np.array([*followed, math.sqrt(1 - (followed**2).sum())])
        turn = upright(up)
        tilt = math.degrees(math.acos(up[2]))
        notes.append(f"levelled by {tilt:.0f} degrees: so far the ground is tilted")
    angle, share = row_angle(wood.turned(turn))
    if abs(math.degrees(angle)) >= ASKEW and share >= ALIKE:
        turn = turned(np.array([0.0, 0.0, -angle])) @ turn
        notes.append(f"turned by {math.degrees(angle):.0f} degrees about Z, to the row")
    return turn, notes


def _tilts(up: Floats) -> Floats:
    """Degrees (2,) by which a direction (3,) leans along the row and across it."""
    return np.asarray(np.degrees(np.arcsin(np.abs(up[:2]))))


def ground_normal(xyz: Floats, rng: np.random.Generator) -> Floats | None:
    """The upward normal (3,) of the ground under a scan; None where little ground is in view."""
    low = lowest(xyz)
    if len(low) < FEW:
        return None
    corners = low[rng.integers(len(low), size=(TRIES, 3))]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(normal, axis=1)
    normal *= (np.where(normal[:, 2] < 0, -1, 1) / np.maximum(size, 1e-12))[:, None]
    fits = (normal[:, 2] > math.cos(math.radians(STEEPEST))) & (size > BROAD)
    normal, corners = normal[fits], corners[fits]
    if len(normal) == 0:
        return None
    height = low @ normal.T - (corners[:, 0] * normal).sum(axis=1)
    on, below = (np.abs(height) < 2 * FLAT).sum(axis=0), (height < -3 * FLAT).sum(axis=0)
    best = int((on - BELOW * below).argmax())
    found, middle = normal[best], corners[best, 0]
    for thick in (2 * FLAT, FLAT, FLAT, FLAT):
        near = low[np.abs((low - middle) @ found) < thick]
        if len(near) < FEW:
            return None
        middle = near.mean(axis=0)
        axes = np.linalg.eigh(np.cov((near - middle).T))[1]
        found = axes[:, 0] * (1 if axes[2, 0] > 0 else -1)
    return found if len(near) >= GROUND * len(low) else None


def lowest(xyz: Floats) -> Floats:
    """The lowest point of each square of the ground plan; points almost alone are strays."""
    _, cube, held = np.unique(cubes(xyz, CUBE), return_inverse=True, return_counts=True)
    xyz = xyz[held[cube] >= ALONE]
    square = np.floor(xyz[:, :2] / SQUARE).astype(np.int64)
    order = np.lexsort([xyz[:, 2], square[:, 1], square[:, 0]])
    first = np.ones(len(order), np.bool_)
    first[1:] = (np.diff(square[order], axis=0) != 0).any(axis=1)
    return np.asarray(xyz[order[first]])


def row_angle(wood: Wood) -> tuple[float, float]:
    """The angle of the row about Z, from X, radians; the share of the level wood that runs so."""
    weight = wood.linear * (np.abs(wood.directions[:, 2]) < LEVEL)
    angles = np.arctan2(wood.directions[:, 1], wood.directions[:, 0])
    if weight.sum() <= 0:
        return 0.0, 0.0
    tried = np.radians(np.arange(-90, 90))
    best = float(tried[(_beside(angles, tried[:, None]) @ weight).argmax()])
    for _ in range(5):
        near = weight * _beside(angles, best)
        best += float((near * _between(angles, best)).sum() / near.sum())
    share = weight[np.abs(_between(angles, best)) < 1.5 * BESIDE].sum() / weight.sum()
    return best, float(share)


def _between(angles: Floats, other: Floats | float) -> Floats:
    """From one line to others, in -90 to 90 degrees, radians."""
    return np.asarray(np.angle(np.exp(2j * (angles - other))) / 2)


def _beside(angles: Floats, other: Floats | float) -> Floats:
    return np.asarray(np.exp(-0.5 * (_between(angles, other) / BESIDE) ** 2))
