"""Levelled by the ground, as far as that tells."""

import numpy as np
import pytest

from prunus.frames.ground import Ground
from prunus.frames.level import levelling
from prunus.model import Floats
from prunus.model.rotations import turned, upright


def strip(tilt: Floats, length: float = 3.0, width: float = 0.4) -> Ground:
    """A strip of ground along X, turned by a vector in degrees."""
    turn = turned(np.radians(tilt))
    return Ground(
        up=turn[:, 2],
        middle=np.zeros(3),
        cells=np.ones(1, np.bool_),
        along=turn[:, 0],
        length=length,
        width=width,
    )


@pytest.mark.parametrize("tilt", [[0.0, 14, 0], [-20.0, 0, 0], [12.0, -9, 0], [0.0, -3.5, 0]])
def test_tilted_ground_is_levelled(tilt: list[float]) -> None:
    ground = strip(np.array(tilt))
    turn, degrees = levelling(ground)
    assert turn @ ground.up == pytest.approx([0, 0, 1])
    assert degrees == pytest.approx(np.linalg.norm(tilt), abs=0.5)


@pytest.mark.parametrize("tilt", [[0.0, 2, 0], [7.0, 0, 0], [0.0, 0, 30]])
def test_what_cannot_be_told_is_left_alone(tilt: list[float]) -> None:
    turn, degrees = levelling(strip(np.array(tilt)))
    assert np.array_equal(turn, np.eye(3))
    assert degrees == 0


def test_across_a_narrow_strip_nothing_is_followed_that_is_followed_along_it() -> None:
    ground = strip(np.array([7.0, 10, 0]))
    turn, degrees = levelling(ground)
    assert degrees == pytest.approx(10, abs=0.2)
    assert (turn @ ground.along)[2] == pytest.approx(0, abs=0.03)


def test_upright_is_the_least_rotation() -> None:
    up = np.array([0.3, -0.2, 0.9])
    up /= np.linalg.norm(up)
    turn = upright(up)
    assert turn @ up == pytest.approx([0, 0, 1])
    assert turn @ turn.T == pytest.approx(np.eye(3))
    assert np.arccos((np.trace(turn) - 1) / 2) == pytest.approx(np.arccos(up[2]))
