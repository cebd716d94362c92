"""The frame found by the evidence in the cloud."""

import numpy as np
import pytest

from prunus.model import FRAMES
from prunus.sensing.orient import find_frame, local_wood
from tests.conftest import simulated


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("frame", sorted(FRAMES))
def test_simulated_scans_are_told_right(seed: int, frame: str) -> None:
    _, cloud = simulated(seed)
    found, why = find_frame(local_wood(cloud.xyz @ FRAMES[frame]))
    assert found == frame
    assert "most wood runs along" in why


def test_a_ball_is_undecided_and_said_so(rng: np.random.Generator) -> None:
    found, why = find_frame(local_wood(rng.normal(size=(4000, 3))))
    assert found == "z-up"
    assert why.startswith("undecided")


def test_one_point_does_not_break_it() -> None:
    assert find_frame(local_wood(np.zeros((1, 3))))[0] == "z-up"
