"""Logistic regression: for the calibration of networks, and for the hand-made scorer."""

from __future__ import annotations

import numpy as np

from prunus.model import Bools, Floats


def fit_logistic(features: Floats, valid: Bools, ridge: float = 1e-3) -> Floats:
    """Weights (F + 1,), the offset last, of a logistic regression, by Newton's method.

    `ridge` keeps the weights small, as for features of deviation 1; the offset stays free.
    """
    columns = np.column_stack([features, np.ones(len(features))])
    weights = np.zeros(columns.shape[1])
    held = np.full(columns.shape[1], ridge)
    held[-1] = 1e-3
    for _ in range(50):
        guess = 1 / (1 + np.exp(-columns @ weights))
        slope = columns.T @ (valid - guess) - held * weights
        bend = (columns.T * (guess * (1 - guess))) @ columns + np.diag(held)
        weights += np.linalg.solve(bend, slope)
    return weights
