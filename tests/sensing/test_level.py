"""Which way is up and where the row runs, on drawn scenes and simulated rows."""

import math

import numpy as np
import pytest

from prunus.model import Floats
from prunus.model.rotations import upright
from prunus.sensing.level import ASKEW, find_turn, ground_normal, row_angle
from prunus.sensing.orient import local_wood
from prunus.simulate.scan import simulate_scan


def about_x(degrees: float) -> Floats:
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return np.array([[1, 0, 0], [0, c, -s], [0, s, c]])


def about_z(degrees: float) -> Floats:
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def field(rng: np.random.Generator) -> Floats:
    """A broad strip of ground, and stakes on a row behind it joined by rails."""
    ground = np.column_stack([rng.uniform(-1.5, 1.5, 8000), rng.uniform(-1.5, -0.3, 8000),
                              rng.normal(0, 0.01, 8000)])  # fmt: skip
    rails = np.column_stack([rng.uniform(-1.5, 1.5, 4000), rng.normal(0.3, 0.01, 4000),
                             rng.choice([0.5, 1.0], 4000) + rng.normal(0, 0.01, 4000)])  # fmt: skip
    return np.concatenate([ground, rails])


@pytest.mark.parametrize("tilt", [-12.0, 10.0])
def test_a_tilted_scan_is_levelled_by_its_ground(tilt: float, rng: np.random.Generator) -> None:
    xyz = field(rng) @ about_x(tilt).T
    turn, notes = find_turn(xyz, local_wood(xyz), rng)
    up = turn @ about_x(tilt) @ [0, 0, 1]
    assert math.degrees(math.acos(min(1.0, up[2]))) < 2
    assert notes and notes[0].startswith("levelled by")


@pytest.mark.parametrize("askew", [-30.0, 20.0])
def test_a_scan_askew_is_turned_to_its_row(askew: float, rng: np.random.Generator) -> None:
    xyz = field(rng) @ about_z(askew).T
    turn, notes = find_turn(xyz, local_wood(xyz), rng)
    along = turn @ about_z(askew) @ [1, 0, 0]
    assert abs(math.degrees(math.atan2(along[1], along[0]))) < 5
    assert any("to the row" in note for note in notes)


@pytest.mark.parametrize("seed", range(500_000, 500_004))
def test_a_level_row_stays_as_it_is(seed: int, rng: np.random.Generator) -> None:
    xyz = simulate_scan(seed).xyz
    turn, notes = find_turn(xyz, local_wood(xyz), rng)
    assert np.array_equal(turn, np.eye(3))
    assert notes == []


def test_no_ground_and_no_wood_say_nothing(rng: np.random.Generator) -> None:
    ball = rng.normal(0, 0.3, (3000, 3))
    assert ground_normal(ball, rng) is None
    assert ground_normal(np.zeros((1, 3)), rng) is None
    angle, share = row_angle(local_wood(ball))
    assert share < 0.6 or abs(angle) < math.radians(ASKEW)


def test_upright_is_the_least_rotation() -> None:
    up = np.array([0.3, -0.2, 0.9])
    up /= np.linalg.norm(up)
    turn = upright(up)
    assert turn @ up == pytest.approx([0, 0, 1])
    assert turn @ turn.T == pytest.approx(np.eye(3))
    assert math.acos((np.trace(turn) - 1) / 2) == pytest.approx(math.acos(up[2]))
