"""How finely numbers are told: the step in which the coordinates of a cloud come."""

from __future__ import annotations

import numpy as np

from prunus.model.arrays import Floats

MAX_NUMBERS = 20_000
"""Longer columns are thinned to so many numbers before they are looked at."""
MIN_NUMBERS = 50
"""Of fewer numbers no step can be told."""
DECIMAL = (1.0, 0.1, 0.01, 0.001)
"""Steps of what was written with few digits."""
DIGITS = 4
"""Numbers that are the same to so many digits are one."""
APART = 3
"""Of fewer differences only the step of single precision is told: it is known before."""
OFF, MOST_ON = 0.1, 0.98
"""On a grid lies what is off by less of its step; so many numbers do, as a few may be of another
kind."""
SPLIT = 2
"""Numbers at one place of a grid may be told as so many."""


def step_of(values: Floats) -> tuple[float, bool]:
    """The largest step in which numbers (P,) come, 0 where in none; whether single precision's is.

    They may have been rounded again on their way through text.
    """
    values = values[:: -(-len(values) // MAX_NUMBERS) or 1]
    if len(values) < MIN_NUMBERS or values.min() == values.max():
        return 0.0, False
    single = float(np.spacing(np.float32(np.quantile(np.abs(values), 0.01))))
    steps = [(step, False) for step in _rounded(values) if step > single]
    if _on_grid(values, single):
        steps.append((single, True))
    return max(steps, default=(0.0, False))


def _rounded(values: Floats) -> list[float]:
    """Steps in which numbers come that somebody rounded: few digits, or places of a raster."""
    apart = np.diff(np.unique(np.round(values, DIGITS)))
    if len(apart) < APART:
        return []
    steps = [step for step in DECIMAL if _on_grid(values, step)]
    least = float(apart.min())
    if least >= DECIMAL[-1] and _on_grid(values - values.min(), least):
        steps.append(least)
    return steps


def _on_grid(values: Floats, step: float) -> bool:
    """Whether numbers lie at multiples of a step, and not just about one, as what is thin does."""
    count = np.round(values / step)
    on = np.abs(values / step - count) < OFF
    if on.mean() <= MOST_ON:
        return False
    return len(np.unique(np.round(values[on], DIGITS))) <= SPLIT * len(np.unique(count[on]))
