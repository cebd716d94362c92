"""Logistic regression: for the calibration of networks, and for the hand-made scorer."""

from __future__ import annotations

import numpy as np

from prunus.model import Bools, Floats


def fit_logistic(features: Floats, valid: Bools) -> Floats:
    """Weights (F + 1,), the offset last, of a logistic regression, by Newton's method."""
    columns = np.column_stack([features, np.ones(len(features))])
    weights = np.zeros(columns.shape[1])
    for _ in range(50):
        guess = 1 / (1 + np.exp(-columns @ weights))
        slope = columns.T @ (valid - guess) - 1e-3 * weights
        bend = (columns.T * (guess * (1 - guess))) @ columns + 1e-3 * np.eye(len(weights))
        weights += np.linalg.solve(bend, slope)
    return weights
