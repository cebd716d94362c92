"""The steps in which numbers come."""

import numpy as np
import pytest

from prunus.model.steps import step_of


@pytest.mark.parametrize("width", [0.02, 0.06, 0.15, 0.5, 3.0])
@pytest.mark.parametrize("middle", [0.0, 1.0, -3.0, 0.5])
def test_a_thin_cloud_about_a_round_number_comes_in_no_steps(width: float, middle: float) -> None:
    values = middle + np.random.default_rng(0).uniform(-width / 2, width / 2, 5000)
    assert step_of(values) == (0.0, False)


@pytest.mark.parametrize("step", [1.0, 0.1, 0.05, 0.03, 0.01])
def test_rounded_numbers_come_in_their_steps(step: float) -> None:
    values = np.round(np.random.default_rng(0).uniform(-2, 2, 5000) / step) * step
    assert step_of(values) == (pytest.approx(step), False)
