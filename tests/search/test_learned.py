"""The learned score and its search, on graphs small enough to see through."""

from pathlib import Path

import numpy as np
import pytest

from prunus.errors import PrunusError
from prunus.model import (
    CandidateGraph,
    Floats,
    Label,
    PointCloud,
    ScoredGraph,
    SeededGraph,
    Superpoints,
)
from prunus.rules import offenders
from prunus.search.learned import (
    CHANGES,
    TERMS,
    TURNS,
    LearnedScore,
    learned_score_of,
    search_learned,
    shipped_score,
)
from tests.search.graphs import random_graph

PLAIN = {"wood": 2.0, "length": -1.0, "confidence": 1.0, "category": 1.0}


def plain() -> LearnedScore:
    """Wood pays, length costs, turns are free."""
    edge = np.tile([PLAIN.get(term, 0.0) for term in TERMS], (len(Label), 1))
    return LearnedScore(edge, np.zeros((len(CHANGES), len(TURNS) + 1)))


def graph(nodes: Floats, category: Floats, confidence: float = 0.95) -> SeededGraph:
    """All pairs within 25 cm, each node standing for 10 cm of wood; node 0 is the base."""
    cloud = PointCloud.from_xyz(nodes)
    away = np.linalg.norm(cloud.xyz[:, None] - cloud.xyz, axis=2)
    edges = np.argwhere(np.triu(away < 0.25, 1))
    own = Superpoints.of_nodes(cloud, 0.1)
    kinds = np.tile(category, (len(edges), 1))
    scored = ScoredGraph(
        CandidateGraph(own, edges), np.full(len(edges), confidence), kinds, "drawn"
    )
    return SeededGraph(scored, 0, np.array([len(nodes) - 1]))


def test_the_score_survives_its_file(tmp_path: Path) -> None:
    path = tmp_path / "score.toml"
    path.write_text(shipped_score().to_toml())
    again = LearnedScore.from_toml(path)
    assert np.array_equal(again.edge, shipped_score().edge)
    assert np.array_equal(again.turn, shipped_score().turn)


@pytest.mark.parametrize("text", ["", "[edge.trunk]\nwood = 1", "wood"])
def test_a_file_that_is_no_score_is_refused_by_name(tmp_path: Path, text: str) -> None:
    path = tmp_path / "none.toml"
    path.write_text(text)
    with pytest.raises(PrunusError, match=r"none.toml: not a (learned score|TOML file)"):
        LearnedScore.from_toml(path)


def test_wood_pays_once_so_one_branch_is_one_path() -> None:
    """Paths that skip every other node would explain the same wood side by side."""
    nodes = np.array([(0.0, 0.0, 0.1 * k) for k in range(12)])
    trunk = np.array([0.96, 0.01, 0.01, 0.01, 0.01])
    found = search_learned(graph(nodes, trunk), plain()).skeleton
    assert found.superpoint.tolist() == list(range(12))
    assert found.parent.tolist() == list(range(-1, 11))


def test_what_no_confidence_supports_is_left_out() -> None:
    nodes = np.array([(0.0, 0.0, 0.1 * k) for k in range(6)])
    trunk = np.array([0.96, 0.01, 0.01, 0.01, 0.01])
    assert len(search_learned(graph(nodes, trunk, confidence=0.05), plain()).skeleton) == 1


@pytest.mark.parametrize("seed", range(10))
def test_the_score_told_is_that_of_the_skeleton_and_the_rules_hold(seed: int) -> None:
    bare = random_graph(seed, nodes=30, edges=80)
    rng = np.random.default_rng(seed)
    category = rng.dirichlet(np.ones(5), len(bare.edges))
    scored = ScoredGraph(bare.scored.candidates, bare.confidence, category, "random")
    seeded = SeededGraph(scored, bare.base, bare.tips)
    found = search_learned(seeded, shipped_score())
    assert offenders(found.skeleton) == {}
    told = learned_score_of(found.skeleton, seeded, shipped_score())
    assert found.score == pytest.approx(told, abs=1e-6)
    assert found.score >= 0
