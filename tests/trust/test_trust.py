"""Trust as numbers and words: what is not known, whom it is said of, what a person is told."""

import math

import numpy as np
import pytest

from prunus.model import Label
from prunus.model.branches import branches
from prunus.params import Parameters
from prunus.pipeline import skeletonize
from prunus.trust import Trust
from prunus.trust.odds import Odds
from prunus.trust.review import review_of
from tests.conftest import simulated
from tests.drawn import tree


def test_what_is_not_known_counts_as_usual() -> None:
    odds = Odds(0.0, {"a": 2.0, "b": 1.0}, {"a": 1.0, "b": 5.0})
    assert odds({"a": 1.0, "b": 5.0}) == pytest.approx(0.5)
    assert odds({"a": math.nan, "b": 6.0}) == pytest.approx(1 / (1 + math.exp(-1)))


def test_the_papers_way_has_no_trust() -> None:
    truth, cloud = simulated(2, 4_000)
    paper = Parameters.paper().changed("search", K=20)
    result = skeletonize(cloud, truth.xyz[0], paper)
    assert result.trust is None
    assert result.review == result.warnings


def test_a_person_is_told_what_is_doubtful() -> None:
    drawn = tree()
    some = branches(drawn)
    fine = Trust(edge=np.full(len(drawn), 0.95), branch=np.full(len(some), 0.9), tree=0.95)
    assert review_of(drawn, fine) == []
    doubts = np.array([0.1 if one.label in (Label.LEADER, Label.SIDE_BRANCH) else 0.9
                       for one in some])  # fmt: skip
    told = review_of(drawn, Trust(edge=fine.edge, branch=doubts, tree=0.5))
    assert told[0] == "only 50% of its edges are likely right"
    assert sorted(told[1:]) == [f"leader {n} is likely wrong (10% sure)" for n in (1, 2, 3)]


def test_that_another_tree_may_be_meant_is_not_said_of_every_branch() -> None:
    drawn = tree()
    some = branches(drawn)
    trust = Trust(
        edge=np.full(len(drawn), 0.25), branch=np.full(len(some), 0.24), tree=0.25, meant=0.27
    )
    told = review_of(drawn, trust)
    assert told[0].startswith("another tree in view may be meant as well (27% likely this one)")
    assert told[1:] == ["only 25% of its edges are likely right"]
