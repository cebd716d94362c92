"""The confidence that a cut is right."""

import math
from dataclasses import replace

import pytest

from prunus.cuts.confidence import confidence_of, features, shipped_odds
from prunus.cuts.evidence import Evidence
from prunus.model import Label

NAN = float("nan")
GOOD = Evidence(
    likely=0.95, way=0.95, seen=1.0, length=0.3, diameter=0.01, doubt=0.002, thick=0.4, bend=4.0,
    slant=1.1, touch=0.3, touched="leader 2", upright=80.0, spread=0.009, aside=0.003,
    behind=0.0, past=0.0,
)  # fmt: skip


def sure(evidence: Evidence) -> float:
    return confidence_of(Label.SIDE_BRANCH, evidence)


def test_what_speaks_against_a_branch_lowers_the_confidence() -> None:
    for name, worse in (
        ("likely", 0.5), ("way", 0.5), ("bend", 40.0), ("slant", 3.0), ("spread", 0.02),
        ("aside", 0.015), ("behind", 0.5),
    ):  # fmt: skip
        assert sure(replace(GOOD, **{name: worse})) < sure(GOOD), name


def test_what_is_unknown_counts_as_usual() -> None:
    usual = shipped_odds().usual
    blind = replace(GOOD, spread=NAN, aside=NAN, behind=NAN)
    told = replace(GOOD, spread=usual["spread"], aside=math.exp(usual["aside"]))
    assert sure(blind) == pytest.approx(sure(replace(told, behind=usual["behind"])))


def test_a_branch_of_which_nothing_is_known_has_no_confidence() -> None:
    assert confidence_of(Label.SIDE_BRANCH, replace(GOOD, likely=NAN)) == 0
    assert confidence_of(Label.LEADER, replace(GOOD, likely=NAN)) == 0


def test_no_cut_through_a_leader_is_so_sure_that_a_machine_may_make_it() -> None:
    fine, doubted = replace(GOOD, likely=1.0), replace(GOOD, likely=0.5)
    assert confidence_of(Label.LEADER, doubted) < confidence_of(Label.LEADER, fine) < 0.5


def test_the_shipped_model_knows_every_feature() -> None:
    odds = shipped_odds()
    assert list(odds.weight) == list(odds.usual) == list(features(GOOD))
    assert 0.5 < sure(GOOD) < 1


def test_unknown_confidences_do_not_pass_for_known() -> None:
    assert features(replace(GOOD, likely=0.0))["likely"] == pytest.approx(-3.892, abs=1e-3)
