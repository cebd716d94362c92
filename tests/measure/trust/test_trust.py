"""How far to trust a skeleton: probabilities that follow the evidence."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from prunus.evaluate.right import right_branches
from prunus.measure import branches
from prunus.measure.odds import Odds
from prunus.measure.trust import Known, Model, Trust, shipped_model, trust_in
from prunus.measure.trust.evidence import of_branches
from prunus.measure.trust.review import review_of
from prunus.model import Label, Skeleton
from prunus.params import Parameters
from prunus.pipeline import skeletonize
from prunus.result import Result
from prunus.search import shipped_score
from prunus.search.judged import judged
from tests.conftest import simulated
from tests.drawn import tree


@pytest.fixture(scope="module")
def found() -> Result:
    truth, cloud = simulated(2)
    return skeletonize(cloud, truth.xyz[0], Parameters.learned())


def known(result: Result) -> Known:
    told = judged(result.in_house, result.graph, shipped_score())
    return Known(result.in_house, result.refined, told.gain, told.likely, raw=False)


def test_what_is_not_known_counts_as_usual() -> None:
    odds = Odds(0.0, {"a": 2.0, "b": 1.0}, {"a": 1.0, "b": 5.0})
    assert odds({"a": 1.0, "b": 5.0}) == pytest.approx(0.5)
    assert odds({"a": math.nan, "b": 6.0}) == pytest.approx(1 / (1 + math.exp(-1)))


def test_the_model_survives_its_file(tmp_path: Path) -> None:
    path = tmp_path / "trust.toml"
    path.write_text(shipped_model().to_toml())
    assert Model.from_toml(path) == shipped_model()


def test_nothing_that_speaks_for_a_branch_lowers_its_trust() -> None:
    for odds in (*shipped_model().branch.values(), shipped_model().edge):
        for name in ("least", "kind", "rival", "straight", "touch", "seen", "edge", "branch"):
            assert odds.weight.get(name, 0.0) >= 0, name
        for name in ("bend", "raw"):
            assert odds.weight.get(name, 0.0) <= 0, name


def test_every_branch_and_edge_has_a_probability(found: Result) -> None:
    trust = found.trust
    assert trust is not None
    assert len(trust.branch) == len(branches(found.in_house))
    assert len(trust.edge) == len(found.in_house) and np.isnan(trust.edge[0])
    for values in (trust.branch, trust.edge[1:]):
        assert ((values > 0) & (values < 1)).all()
    assert trust.tree == pytest.approx(float(trust.edge[1:].mean()))


def test_what_is_wrong_is_trusted_less() -> None:
    right, wrong = list[float](), list[float]()
    for seed in (2, 4, 5):
        truth, cloud = simulated(seed)
        result = skeletonize(cloud, truth.xyz[0], Parameters.learned())
        assert result.trust is not None
        fine = right_branches(result.skeleton, truth)
        right += result.trust.branch[fine].tolist()
        wrong += result.trust.branch[~fine].tolist()
    assert len(wrong) > 3
    assert np.mean(right) > np.mean(wrong) + 0.1


def test_without_confidence_there_is_less_trust(found: Result) -> None:
    told, skeleton = known(found), found.in_house
    doubtful = Skeleton.build(
        skeleton.xyz, skeleton.parent, skeleton.label,
        confidence=skeleton.confidence / 2, superpoint=skeleton.superpoint,
    )  # fmt: skip
    less = trust_in(replace(told, skeleton=doubtful))
    assert less.tree < trust_in(told).tree - 0.05


def test_the_score_says_how_far_behind_the_next_best_label_is(found: Result) -> None:
    told = known(found)
    evidence = of_branches(told)
    for branch, of in zip(branches(found.in_house), evidence, strict=True):
        brings = told.gain[branch.rows[1:]].sum(axis=0)
        best = int(brings.argmax()) == branch.label
        assert (of["rival"] >= 0) == best


def test_the_judged_gain_is_that_of_the_score(found: Result) -> None:
    """With turns, gains add up to the score of the search."""
    told = known(found)
    rows = np.arange(1, len(found.in_house))
    without_turns = told.gain[rows, found.in_house.label[1:]].sum()
    assert without_turns >= found.score > 0
    assert told.likely[1:].sum(axis=1).max() <= 1 + 1e-6


def test_the_papers_way_has_no_trust(found: Result) -> None:
    truth, cloud = simulated(2, 4_000)
    paper = Parameters.paper().changed("search", K=20)
    result = skeletonize(cloud, truth.xyz[0], paper)
    assert result.trust is None
    assert result.review == result.warnings


def test_a_person_is_told_what_is_doubtful() -> None:
    drawn = tree()
    some = branches(drawn)
    fine = Trust(np.full(len(drawn), 0.95), np.full(len(some), 0.9), 0.95)
    assert review_of(drawn, fine) == []
    doubts = np.array([0.1 if one.label in (Label.LEADER, Label.SIDE_BRANCH) else 0.9
                       for one in some])  # fmt: skip
    told = review_of(drawn, Trust(fine.edge, doubts, 0.5))
    assert told[0] == "only 50% of its edges are likely right"
    assert sorted(told[1:]) == [f"leader {n} is likely wrong (10% sure)" for n in (1, 2, 3)]
