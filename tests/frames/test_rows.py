"""Along which line the row runs."""

import math

import numpy as np
import pytest
from bench.shapes import HABITS, scanned

from prunus.frames.orient import local_wood
from prunus.frames.patches import Cells
from prunus.frames.rows import ONE_ASKEW_DEG, row_of_trunks, row_turn
from prunus.model import Floats
from prunus.model.rotations import turned
from tests.conftest import field_scan


def about_z(degrees: float) -> Floats:
    return turned(np.array([0, 0, math.radians(degrees)]))


def turn_of(xyz: Floats) -> float:
    cells = Cells.of(xyz)
    return math.degrees(row_turn(cells, local_wood(cells)))


def off_axis(degrees: float) -> float:
    """How far a line at that angle is from X."""
    return abs((degrees + 90) % 180 - 90)


@pytest.mark.parametrize("seed", range(600_000, 600_006))
def test_a_tree_with_its_supports_along_x_stays(seed: int) -> None:
    assert turn_of(field_scan(seed).target_cloud().xyz) == 0


@pytest.mark.parametrize("seed", range(600_000, 600_003))
@pytest.mark.parametrize("askew", [-75.0, -40.0, 30.0, 90.0])
def test_a_tree_askew_is_turned_to_its_supports(seed: int, askew: float) -> None:
    xyz = field_scan(seed).target_cloud().xyz @ about_z(askew).T
    assert off_axis(turn_of(xyz) + askew) < ONE_ASKEW_DEG


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("habit", ["spindle", "vase"])
@pytest.mark.parametrize("front", [True, False])
def test_a_lone_tree_that_branches_all_round_has_no_row(seed: int, habit: str, front: bool) -> None:
    rng = np.random.default_rng(seed)
    assert turn_of(scanned(rng, HABITS[habit](rng), front)) == 0


@pytest.mark.parametrize("askew", [-50.0, 0.0, 20.0, 85.0])
def test_spindles_in_line_are_a_row(askew: float) -> None:
    rng = np.random.default_rng(5)
    trees = [scanned(rng, HABITS["spindle"](rng), front=False) for _ in range(4)]
    row = [tree + np.array([1.2 * k, 0, 0]) for k, tree in enumerate(trees)]
    assert off_axis(turn_of(np.concatenate(row) @ about_z(askew).T) + askew) < 6


@pytest.mark.parametrize("places", [[(0, 0), (1, 0)], [(0, 0), (1, 0.6), (2, 0)]])
def test_two_trunks_or_three_out_of_line_are_none(places: list[tuple[float, float]]) -> None:
    height = np.arange(0, 2, 0.02)
    posts = [np.column_stack([height * 0 + x, height * 0 + y, height]) for x, y in places]
    assert row_of_trunks(Cells(np.concatenate(posts), 0.03)) == (0.0, 0.0)
