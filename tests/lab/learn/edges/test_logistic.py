"""Odds that are learned from what was right."""

import math

import numpy as np
import pytest

from prunus.lab.learn.edges.logistic import fit_odds


def test_the_odds_come_back() -> None:
    rng = np.random.default_rng(0)
    told = [{"a": a, "b": b} for a, b in rng.normal(3, 2, (4000, 2)).tolist()]
    likely = [1 / (1 + math.exp(-(0.5 + 1.5 * (one["a"] - 3)))) for one in told]
    odds = fit_odds(told, rng.random(4000) < likely)
    assert odds.weight["a"] == pytest.approx(1.5, abs=0.15)
    assert odds.weight["b"] == pytest.approx(0.0, abs=0.1)
    assert odds({"a": 3.0, "b": 3.0}) == pytest.approx(1 / (1 + math.exp(-0.5)), abs=0.03)


def test_evidence_that_speaks_the_wrong_way_is_left_out() -> None:
    told = [{"a": float(a % 7), "b": float(-a)} for a in range(40)]
    right = np.array([a >= 20 for a in range(40)])
    assert fit_odds(told, right, ridge=1.0).weight["b"] < 0
    held = fit_odds(told, right, ridge=1.0, signs={"b": 1})
    assert list(held.weight) == ["a"]
    assert held({"a": 3.0, "b": 5.0}) == held({"a": 3.0, "b": -5.0})


def test_a_ridge_keeps_weights_small_where_nothing_was_wrong() -> None:
    told = [{"a": float(a)} for a in range(20)]
    right = np.array([a >= 10 for a in range(20)])
    free, held = fit_odds(told, right), fit_odds(told, right, ridge=2.0)
    assert 0 < held.weight["a"] < free.weight["a"] / 2
