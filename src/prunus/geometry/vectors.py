"""Vectors of length 1."""

from __future__ import annotations

import numpy as np

from prunus.model.arrays import Floats

LEAST_M = 1e-9
"""What is shorter has no direction."""


def unit(vectors: Floats) -> Floats:
    """The vectors (..., 3) at length 1; hardly any length where they have none."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.asarray(vectors / np.maximum(length, LEAST_M))
