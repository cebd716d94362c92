"""Laws: turning the axes of a file changes nothing, or is told of."""

import math

import numpy as np
import pytest
from bench.shapes import HABITS, axis_rotations, scanned, with_floor

from prunus.frames.orient import UPWARD
from prunus.frames.stance import Stance, find_stance
from prunus.model import FRAMES, ROW_TOLD, Floats
from prunus.model.rotations import turned
from tests.conftest import field_scan

CLOUDS = ["spindle", "field"]


def cloud(name: str, share: float) -> Floats:
    rng = np.random.default_rng(1)
    if name == "field":
        xyz = field_scan(600_001).target_cloud().xyz
    else:
        xyz = scanned(rng, HABITS[name](rng), front=False)
    return with_floor(rng, xyz, share) if share else xyz


def left_of(stance: Stance, askew: Floats) -> Floats:
    """What is left to turn (3, 3) of a cloud in the house frame that was turned askew."""
    return stance.turn @ FRAMES[stance.frame] @ askew


def tilt(left: Floats) -> float:
    return math.degrees(math.acos(min(1.0, left[2, 2])))


@pytest.mark.parametrize("turn", axis_rotations())
@pytest.mark.parametrize("share", [0.0, 0.5, 0.9])
@pytest.mark.parametrize("name", CLOUDS)
@pytest.mark.slow
def test_turning_the_axes_changes_nothing_or_is_warned_of(
    name: str, share: float, turn: Floats
) -> None:
    stance = find_stance(cloud(name, share) @ turn.T)
    left = left_of(stance, turn)
    if stance.notes[0].startswith("undecided"):
        told = {name for name, frame in FRAMES.items() if np.allclose(frame[2], turn[:, 2])}
        assert any(name in stance.notes[0] for name in told & set(UPWARD.values()))
        return
    assert tilt(left) < 3
    if name == "field":
        along = abs(math.degrees(math.atan2(left[1, 0], left[0, 0])))
        assert min(along, 180 - along) < 15


@pytest.mark.parametrize("seed", range(600_000, 600_006))
@pytest.mark.slow
def test_a_hand_cleaned_tree_stays_as_it_is(seed: int) -> None:
    stance = find_stance(field_scan(seed).target_cloud().xyz)
    assert np.array_equal(stance.turn @ FRAMES[stance.frame], np.eye(3))


@pytest.mark.parametrize("seed", range(500_000, 500_004))
@pytest.mark.slow
def test_a_level_row_stays_as_it_is(seed: int) -> None:
    stance = find_stance(field_scan(seed).xyz)
    assert np.array_equal(stance.turn @ FRAMES[stance.frame], np.eye(3))
    assert len(stance.notes) == 1


@pytest.mark.parametrize("degrees", [-14.0, 11.0])
def test_a_camera_that_looks_down_is_levelled(degrees: float) -> None:
    askew = turned(np.array([math.radians(degrees), 0, 0]))
    stance = find_stance(field_scan(500_003).xyz @ askew.T)
    assert tilt(left_of(stance, askew)) < 3
    assert any(note.startswith("levelled by") for note in stance.notes)


@pytest.mark.parametrize("frame", [*FRAMES])
def test_a_frame_that_is_told_is_never_levelled(frame: str) -> None:
    askew = turned(np.array([0.2, 0, 0]))
    stance = find_stance(field_scan(500_000).xyz @ askew.T @ FRAMES[frame], frame)
    assert stance.frame == frame
    assert stance.turn[2] == pytest.approx([0, 0, 1])
    if frame in ROW_TOLD:
        assert np.array_equal(stance.turn, np.eye(3))


@pytest.mark.parametrize("frame", ["z-up", "y-up", "z-down", "x-up", "x-down"])
def test_the_row_is_found_where_the_frame_does_not_tell_it(frame: str) -> None:
    askew = turned(np.array([0, 0, math.radians(70)]))
    stance = find_stance(field_scan(600_002).xyz @ askew.T @ FRAMES[frame], frame)
    left = stance.turn @ askew
    along = abs(math.degrees(math.atan2(left[1, 0], left[0, 0])))
    assert min(along, 180 - along) < 6
    assert "to the row" in stance.notes[-1]


def test_a_wrong_frame_is_remarked_on() -> None:
    xyz = field_scan(500_000).xyz
    assert find_stance(xyz, "z-up").notes == []
    assert find_stance(xyz, "camera-link").notes == []
    assert "looks like z-up" in find_stance(xyz, "y-up").notes[0]


@pytest.mark.parametrize("away", [-2.0, 2.0])
def test_a_row_along_y_is_turned_so_that_the_sensor_at_the_origin_is_in_front(away: float) -> None:
    xyz = field_scan(600_002).xyz
    row_along_y = (xyz - xyz.mean(axis=0)) @ turned(np.array([0, 0, math.pi / 2])).T
    middle = np.array([away, 0, 0])
    stance = find_stance(row_along_y + middle, "z-up")
    assert (stance.turn @ middle)[1] > 1.5


def test_frames_are_rotations() -> None:
    for turn in FRAMES.values():
        assert np.linalg.det(turn) == pytest.approx(1)
