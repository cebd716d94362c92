"""Where sensors stood: laws of turns, and trees of frames worked out by hand."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from prunus.io.ros.transforms import REACH, Joint, Transforms, between, rotation
from prunus.model import Floats

NUMBERS = st.floats(-1, 1)
TURNS = (
    st.tuples(NUMBERS, NUMBERS, NUMBERS, NUMBERS)
    .map(np.array)
    .filter(lambda turn: np.linalg.norm(turn) > 0.1)
    .map(lambda turn: turn / np.linalg.norm(turn))
)
QUARTER = np.array([0, 0, np.sqrt(0.5), np.sqrt(0.5)])


def joint(parent: str, *places: float) -> Joint:
    """A joint that is at these x, a second apart from 10 s on."""
    time = (10 + np.arange(len(places))) * 10**9
    place = np.zeros((len(places), 3))
    place[:, 0] = places
    return Joint(
        parent=parent, time=time, place=place, turn=np.tile([0.0, 0, 0, 1], (len(places), 1))
    )


@given(TURNS)
def test_a_turn_is_a_rotation_and_its_opposite_the_same(turn: Floats) -> None:
    matrix = rotation(turn)
    assert matrix @ matrix.T == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(matrix) == pytest.approx(1)
    assert rotation(-turn) == pytest.approx(matrix)


@given(TURNS, TURNS, st.floats(0, 1))
def test_between_two_turns_the_angle_is_in_proportion(
    begin: Floats, end: Floats, share: float
) -> None:
    if abs(begin @ end) > 1e-3:  # the shorter way of two is a matter of rounding at half a turn
        whole = np.arccos(min(1, abs(begin @ end)))
        part = np.arccos(min(1, abs(begin @ between(begin, end, share))))
        assert part == pytest.approx(share * whole, abs=1e-6)


def test_a_quarter_turn_about_z_takes_x_to_y() -> None:
    assert rotation(QUARTER) @ [1, 0, 0] == pytest.approx([0, 1, 0])


def test_a_joint_moves_between_its_samples_and_holds_a_second_beyond() -> None:
    arm = joint("base", 1, 3)
    at = {
        time: None if motion is None else float(motion.translation[0])
        for time in (8.9, 9.0, 10.0, 10.25, 11.0, 12.0, 12.1)
        for motion in [arm.at(round(time * 1e9))]
    }
    assert at == {8.9: None, 9.0: 1, 10.0: 1, 10.25: 1.5, 11.0: 3, 12.0: 3, 12.1: None}


def test_a_joint_that_does_not_move_holds_for_ever() -> None:
    still = joint("base", 1, 1).at(10**6 * REACH)
    assert not joint("base", 1, 1).moves and still is not None
    assert still.translation.tolist() == [1, 0, 0]


def test_the_way_up_adds_up_and_a_loop_ends() -> None:
    tree = Transforms({"eye": joint("arm", 1), "arm": joint("base", 2, 4)})
    assert tree.above("eye") == ["eye", "arm", "base"] and tree.moves("eye")
    motion = tree.to_root("eye", 10 * 10**9)
    assert motion is not None and motion.translation.tolist() == [3, 0, 0]
    loop = Transforms({"a": joint("b", 1), "b": joint("a", 1)})
    assert loop.above("a") == ["a", "b"] and not loop.moves("a")
