"""Rotations by vectors along their axis, as long as their angle in radians (Rodrigues)."""

from __future__ import annotations

import math

import numpy as np

from prunus.model.arrays import Floats
from prunus.model.cloud import RigidMotion

TINY = 1e-12


def turned(turn: Floats) -> Floats:
    """The rotation (3, 3) by a rotation vector (3,), radians (Rodrigues)."""
    angle = float(np.linalg.norm(turn))
    across = cross(turn)
    if angle < 1e-9:
        return np.eye(3) + across
    bend = (1 - math.cos(angle)) / angle**2
    return np.asarray(np.eye(3) + math.sin(angle) / angle * across + bend * across @ across)


def turn_of(pose: RigidMotion, before: RigidMotion) -> Floats:
    """The rotation vector (3,), radians, from one pose to another; under half a turn."""
    rotation = pose.rotation @ before.rotation.T
    skew = (rotation - rotation.T) / 2
    sines = np.array([skew[2, 1], skew[0, 2], skew[1, 0]])
    sine = float(np.linalg.norm(sines))
    angle = math.atan2(sine, (np.trace(rotation) - 1) / 2)
    return sines if sine < 1e-9 else sines * (angle / sine)


def upright(up: Floats) -> Floats:
    """The least rotation (3, 3) that turns a direction (3,) to Z."""
    axis = np.array([up[1], -up[0], 0.0])
    sine = float(np.linalg.norm(axis))
    return turned(axis * (math.atan2(sine, up[2]) / sine)) if sine > TINY else np.eye(3)


def cross(v: Floats) -> Floats:
    """The matrix (3, 3) that multiplies a vector (3,) by another, from the left."""
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])
