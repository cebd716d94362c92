"""What is ground, and what is none."""

import math

import numpy as np
import pytest
from bench.shapes import HABITS, axis_rotations, scanned, with_floor

from prunus.frames.ground import find_ground
from prunus.frames.patches import Cells
from prunus.model import Floats
from prunus.model.rotations import turned
from tests.conftest import field_scan


def degrees_off(found: Floats, up: Floats) -> float:
    return math.degrees(math.acos(min(1.0, float(found @ up))))


def drawn(habit: str, seed: int = 0) -> Floats:
    rng = np.random.default_rng(seed)
    return scanned(rng, HABITS[habit](rng), front=False)


@pytest.mark.parametrize("seed", range(600_000, 600_006))
@pytest.mark.slow
def test_a_hand_cleaned_tree_has_no_ground(seed: int) -> None:
    assert find_ground(Cells.of(field_scan(seed).target_cloud().xyz)) is None


@pytest.mark.parametrize("habit", sorted(HABITS))
def test_no_crown_is_ground(habit: str) -> None:
    assert find_ground(Cells.of(drawn(habit))) is None


@pytest.mark.parametrize("share", [0.3, 0.75, 0.95])
@pytest.mark.parametrize("turn", axis_rotations()[::4])
def test_a_floor_is_ground_whatever_it_holds(
    share: float, turn: Floats, rng: np.random.Generator
) -> None:
    ground = find_ground(Cells.of(with_floor(rng, drawn("spindle"), share) @ turn.T))
    assert ground is not None
    assert degrees_off(ground.up, turn[:, 2]) < 1


@pytest.mark.parametrize("seed", range(500_000, 500_003))
def test_a_strip_of_rough_ground_is_found_askew(seed: int, rng: np.random.Generator) -> None:
    askew = turned(np.radians(rng.uniform(-12, 12, 3)))
    ground = find_ground(Cells.of(field_scan(seed).xyz @ askew.T))
    assert ground is not None
    assert degrees_off(ground.up, askew[:, 2]) < 4


def wall(rng: np.random.Generator, xyz: Floats) -> Floats:
    """A wall that stands behind a tree."""
    across = rng.uniform(-2, 2, 60_000)
    height = rng.uniform(xyz[:, 2].min(), xyz[:, 2].max(), 60_000)
    behind = xyz[:, 1].max() + 0.3 + rng.normal(0, 0.01, 60_000)
    return np.concatenate([xyz, np.column_stack([across, behind, height])])


@pytest.mark.parametrize("habit", ["spindle", "forked", "vase"])
def test_a_wall_is_no_ground(habit: str, rng: np.random.Generator) -> None:
    assert find_ground(Cells.of(wall(rng, drawn(habit)))) is None


@pytest.mark.parametrize("habit", ["spindle", "vase"])
def test_ground_is_found_before_a_wall(habit: str, rng: np.random.Generator) -> None:
    ground = find_ground(Cells.of(wall(rng, with_floor(rng, drawn(habit), 0.6, side=3.0))))
    assert ground is not None
    assert degrees_off(ground.up, np.array([0.0, 0, 1])) < 1


def test_a_floor_alone_says_nothing(rng: np.random.Generator) -> None:
    floor = np.column_stack([rng.uniform(-2, 2, (20_000, 2)), rng.normal(0, 0.01, 20_000)])
    assert find_ground(Cells.of(floor)) is None
    assert find_ground(Cells.of(np.zeros((1, 3)))) is None
