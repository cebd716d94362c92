"""Where a foot that was found is put."""

from dataclasses import replace

import numpy as np
import pytest

from prunus.model import PointCloud, ScoredGraph, Superpoints
from prunus.paper.candidates import find_candidates
from prunus.paper.trunks import on_wood


@pytest.fixture
def post() -> ScoredGraph:
    """Superpoints on an upright line, every edge of sure wood."""
    xyz = np.column_stack([np.zeros(8), np.zeros(8), np.arange(8) * 0.1])
    candidates = find_candidates(Superpoints.of_nodes(PointCloud.from_xyz(xyz), 0.1))
    return ScoredGraph.of_confidence(candidates, np.ones(len(candidates.edges)), "drawn")


@pytest.mark.parametrize("away", [0.0, 0.1])
def test_a_foot_beside_wood_stays(post: ScoredGraph, away: float) -> None:
    foot = post.xyz[0] + [away, 0, 0]
    assert np.array_equal(on_wood(foot, post), foot)


@pytest.mark.parametrize("away", [0.2, 3.0])
def test_a_foot_beside_no_wood_is_put_on_the_nearest(post: ScoredGraph, away: float) -> None:
    assert on_wood(post.xyz[0] + [away, 0, 0], post) == pytest.approx(post.xyz[0])


def test_without_wood_there_is_no_foot(post: ScoredGraph) -> None:
    doubtful = replace(post, confidence=np.zeros(len(post.edges)))
    assert on_wood(post.xyz[0], doubtful) is None
    assert on_wood(None, post) is None
