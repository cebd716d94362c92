"""Which axis points up, by the tree alone."""

import numpy as np
import pytest
from bench.shapes import HABITS, scanned

from prunus.frames.orient import UPWARD, Up, find_frame, local_wood, rooted, thicker_below
from prunus.frames.patches import Cells
from prunus.model import FRAMES, Floats
from tests.conftest import field_scan

SIX = list(UPWARD.values())


def up_of(xyz: Floats) -> Up:
    cells = Cells.of(xyz)
    return find_frame(cells, local_wood(cells), None)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("frame", SIX)
@pytest.mark.slow
def test_a_hand_cleaned_tree_says_which_axis_is_up(seed: int, frame: str) -> None:
    xyz = field_scan(seed).target_cloud().xyz @ FRAMES[frame]
    up = up_of(xyz)
    assert up.frame == frame or frame in up.others


@pytest.mark.parametrize("habit", sorted(HABITS))
@pytest.mark.parametrize("front", [True, False])
@pytest.mark.parametrize("frame", SIX)
def test_trees_of_other_habits_say_it_too(habit: str, front: bool, frame: str) -> None:
    rng = np.random.default_rng(3)
    up = up_of(scanned(rng, HABITS[habit](rng), front) @ FRAMES[frame])
    assert up.frame == frame
    assert "of the wood runs along" in up.why


def test_a_ball_is_undecided_and_the_most_usual_axis_is_taken(rng: np.random.Generator) -> None:
    up = up_of(rng.normal(size=(40_000, 3)))
    assert up.frame == "z-up"
    assert up.others


@pytest.mark.parametrize("count", [1, 2, 5])
def test_hardly_any_points_do_not_break_it(count: int) -> None:
    assert up_of(np.arange(3.0 * count).reshape(-1, 3) * 0.01).frame == "z-up"


def comb(teeth: int) -> Cells:
    """A beam along X, with teeth that stand on it."""
    beam = np.column_stack([np.arange(0, 2, 0.03), np.zeros(67), np.zeros(67)])
    height = np.arange(0.03, 1, 0.03)
    stand = [
        np.column_stack([height * 0 + x, height * 0, height]) for x in np.linspace(0, 2, teeth)
    ]
    return Cells(np.concatenate([beam, *stand]), 0.03)


def test_what_stands_on_one_beam_is_rooted_in_it() -> None:
    along_x, _, upward = rooted(comb(6))
    assert upward > 1.5
    assert abs(along_x) < 0.5
    assert rooted(comb(6).turned(np.diag([1.0, -1, -1])))[2] == pytest.approx(-upward)


def test_a_post_that_tapers_is_thicker_below(rng: np.random.Generator) -> None:
    height, around = rng.uniform(0, 2, 20_000), rng.uniform(0, 2 * np.pi, 20_000)
    radius = 0.045 - 0.018 * height
    post = np.column_stack([radius * np.cos(around), radius * np.sin(around), height])
    assert thicker_below(local_wood(Cells.of(post)))[2] > 0.3
    assert thicker_below(local_wood(Cells.of(-post)))[2] < -0.3
