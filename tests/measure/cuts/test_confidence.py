"""The confidence that a cut is right."""

from dataclasses import replace
from pathlib import Path

import pytest

from prunus.measure.cuts.confidence import Model, confidence_of, features, shipped_model
from prunus.measure.cuts.evidence import Evidence
from prunus.model import Label

NAN = float("nan")
GOOD = Evidence(
    least=0.98, path=0.9, seen=1.0, length=0.3, diameter=0.01, doubt=0.002, thick=0.4, bend=4.0,
    slant=1.1, touch=0.3, touched="leader 2", upright=80.0, spread=0.009, aside=0.003,
    behind=0.0, past=0.0,
)  # fmt: skip


def test_what_speaks_against_a_branch_lowers_the_confidence() -> None:
    model = shipped_model()
    for name, worse in (
        ("least", 0.5), ("touch", 0.01), ("bend", 40.0), ("slant", 3.0), ("spread", 0.02),
        ("aside", 0.015), ("behind", 0.5),
    ):  # fmt: skip
        assert model(replace(GOOD, **{name: worse})) < model(GOOD), name


def test_what_is_unknown_counts_as_usual() -> None:
    model = shipped_model()
    blind = replace(GOOD, spread=NAN, aside=NAN, behind=NAN)
    names = ("spread", "aside", "behind")
    odds = sum(model.weight[k] * (features(GOOD)[k] - model.usual[k]) for k in names)
    assert (model(blind) < model(GOOD)) == (odds > 0)


def test_a_branch_of_which_nothing_is_known_has_no_confidence() -> None:
    assert confidence_of(Label.SIDE_BRANCH, replace(GOOD, least=NAN)) == 0
    assert confidence_of(Label.LEADER, replace(GOOD, least=NAN)) == 0


def test_no_cut_through_a_leader_is_so_sure_that_a_machine_may_make_it() -> None:
    sure, doubted = replace(GOOD, least=1.0), replace(GOOD, least=0.5)
    assert confidence_of(Label.LEADER, doubted) < confidence_of(Label.LEADER, sure) < 0.5


def test_a_model_reads_what_it_wrote(tmp_path: Path) -> None:
    model = Model(0.5, {"least": 1.25}, {"least": -0.125})
    (tmp_path / "model.toml").write_text(model.to_toml("leaders"))
    assert Model.from_toml(tmp_path / "model.toml", "leaders") == model


def test_the_shipped_model_knows_every_feature() -> None:
    model = shipped_model()
    assert list(model.weight) == list(model.usual) == list(features(GOOD))
    assert 0.5 < model(GOOD) < 1


def test_unknown_confidences_do_not_pass_for_known() -> None:
    assert features(replace(GOOD, least=0.0))["least"] == pytest.approx(-3.912, abs=1e-3)
