"""Logistic regression: for the calibration of networks, and for the hand-made scorer."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from prunus.model import Bools, Floats
from prunus.trust.odds import Odds

RIDGE = 1e-3
"""Keeps weights finite where features tell right from wrong without a fault."""


def fit_logistic(features: Floats, valid: Bools, ridge: float = RIDGE) -> Floats:
    """Weights (F + 1,), the offset last, of a logistic regression, by Newton's method.

    `ridge` keeps the weights small, as for features of deviation 1; the offset stays free.
    """
    columns = np.column_stack([features, np.ones(len(features))])
    weights = np.zeros(columns.shape[1])
    held = np.full(columns.shape[1], ridge)
    held[-1] = RIDGE
    for _ in range(50):
        guess = 1 / (1 + np.exp(-columns @ weights))
        slope = columns.T @ (valid - guess) - held * weights
        bend = (columns.T * (guess * (1 - guess))) @ columns + np.diag(held)
        weights += np.linalg.solve(bend, slope)
    return weights


def fit_odds(
    evidence: Sequence[Mapping[str, float]],
    right: Bools,
    ridge: float = RIDGE,
    signs: Mapping[str, int] | None = None,
) -> Odds:
    """The odds that fit some evidence (C) and what was right (C,); NaN counts as usual.

    `signs`: what may speak only for (1) or only against (-1); evidence that a free fit reads the
    other way is left out, so that chance among few examples is not taken for a law.
    """
    names = list(evidence[0])
    while True:
        odds = _free_odds(names, evidence, right, ridge)
        against = [n for n in names if odds.weight[n] * (signs or {}).get(n, 0) < 0]
        if not against:
            return odds
        names = [name for name in names if name not in against]


def _free_odds(
    names: list[str], evidence: Sequence[Mapping[str, float]], right: Bools, ridge: float
) -> Odds:
    values = np.array([[one[name] for name in names] for one in evidence])
    usual, scale = np.nanmean(values, axis=0), np.nanstd(values, axis=0) + TINY
    weights = fit_logistic(np.nan_to_num((values - usual) / scale), right, ridge)
    weight = dict(zip(names, (weights[:-1] / scale).tolist(), strict=True))
    return Odds(float(weights[-1]), weight, dict(zip(names, usual.tolist(), strict=True)))


TINY = 1e-9
