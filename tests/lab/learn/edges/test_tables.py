"""The tables, worked out by hand on a few edges."""

import numpy as np
import pytest

from prunus.lab.learn.edges.tables import calibration_error, measures, table


def test_accuracy_precision_and_recall_of_six_edges() -> None:
    confidence = np.array([0.9, 0.8, 0.3, 0.2, 0.7, 0.1])
    truth = np.array([2, 3, 2, -1, -1, -1])
    category = np.array([2, 2, 2, 0, 0, 0])
    found = measures(confidence, category, truth)
    assert found["validity_accuracy"] == pytest.approx(4 / 6)
    assert found["valid"] == pytest.approx((2 / 3, 2 / 3))
    assert found["invalid"] == pytest.approx((2 / 3, 2 / 3))
    assert found["category_accuracy"] == pytest.approx(2 / 3)
    assert found["leader"] == pytest.approx((2 / 3, 1.0))
    assert np.isnan(found["trunk"][0]) and found["side_branch"][1] == 0.0
    assert any("edge validity | 66.7% | 66.7% | 89.8%" in line for line in table(found, found))


def test_the_calibration_error_is_the_gap_between_confidence_and_share() -> None:
    sure = np.array([0.95] * 10 + [0.15] * 10)
    valid = np.array([True] * 9 + [False] + [True] * 4 + [False] * 6)
    assert calibration_error(sure, valid) == pytest.approx((0.05 * 10 + 0.25 * 10) / 20)
    assert calibration_error(np.ones(4), np.ones(4, bool)) == 0.0
