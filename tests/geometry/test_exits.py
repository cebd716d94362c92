"""Where branches come out of their parents' wood, on lines whose answer is known."""

import math

import numpy as np
import pytest

from prunus.geometry.exits import exit_along
from prunus.model import Floats

PARENT = np.column_stack([np.zeros(41), np.zeros(41), np.linspace(0, 0.8, 41)])


def leaving(at: Floats, degrees: float, length: float = 0.4) -> tuple[Floats, Floats]:
    """A straight branch that leaves a place at an angle from straight on."""
    along = np.linspace(0, length, 21)
    turn = math.radians(degrees)
    return at + along[:, None] * [math.sin(turn), 0, math.cos(turn)], along


@pytest.mark.parametrize("degrees", [20, 30, 60, 90, 120])
def test_a_branch_comes_out_a_radius_over_the_sine_of_its_angle(degrees: float) -> None:
    line, along = leaving(PARENT[20], degrees)
    expected = 0.015 / math.sin(math.radians(degrees))
    assert exit_along(line, along, PARENT, 0.015) == pytest.approx(expected, abs=1e-9)


def test_what_goes_on_from_the_end_has_no_wood_to_come_out_of() -> None:
    line, along = leaving(PARENT[-1], 20)
    assert exit_along(line, along, PARENT, 0.015) == 0


def test_what_turns_at_the_end_comes_out_like_any_other() -> None:
    line, along = leaving(PARENT[-1], 90)
    assert exit_along(line, along, PARENT, 0.015) == pytest.approx(0.015)


def test_what_never_comes_out_is_within_to_its_tip() -> None:
    line, along = leaving(PARENT[20], 2, 0.1)
    assert exit_along(line, along, PARENT, 0.015) == pytest.approx(0.1)


@pytest.mark.parametrize("seed", range(3))
def test_moving_both_changes_nothing(seed: int) -> None:
    rng = np.random.default_rng(seed)
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    line, along = leaving(PARENT[20], 50)
    moved = exit_along(line @ turn + 3, along, PARENT @ turn + 3, 0.02)
    assert moved == pytest.approx(exit_along(line, along, PARENT, 0.02))
