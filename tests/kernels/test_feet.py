"""Where lines leave their parents, against the slow twin and on a drawn case."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from prunus.kernels import reference
from prunus.kernels.feet import feet, within_parents

STEP = 0.01
UP = np.column_stack([np.zeros(31), np.zeros(31), np.arange(31) * STEP])
ASIDE = np.column_stack([np.arange(11) * STEP, np.zeros(11), np.full(11, 0.15)])
START = np.array([0, 31, 42])
PARENT = np.array([-1, 0])


def test_the_foot_of_a_line_lies_in_its_parent() -> None:
    inside = within_parents(np.concatenate([UP, ASIDE]), START, PARENT, np.full(42, 0.025))
    assert np.flatnonzero(inside).tolist() == [31, 32, 33]


def test_the_last_two_stations_of_a_line_are_outside() -> None:
    inside = within_parents(np.concatenate([UP, ASIDE]), START, PARENT, np.full(42, 1.0))
    assert np.flatnonzero(inside).tolist() == list(range(31, 40))


def test_a_slanting_line_leaves_where_it_points() -> None:
    slanting = ASIDE.copy()
    slanting[3:, 2] += (slanting[3:, 0]) - 0.05
    inside = np.zeros(42, np.bool_)
    inside[31:34] = True
    found = feet(np.concatenate([UP, slanting]), START, PARENT, inside, 6, 8, 0.0)
    assert found.tolist() == [-1, 10], "5 cm lower than it started"


@settings(deadline=None, max_examples=40)
@given(seed=st.integers(0, 1000), ahead=st.integers(1, 8), slide=st.integers(0, 9))
def test_lines_leave_from_the_same_stations(seed: int, ahead: int, slide: int) -> None:
    rng = np.random.default_rng(seed)
    size = rng.integers(2, 15, 4)
    lines = [rng.normal(0, 0.05, (n, 3)).cumsum(axis=0) for n in size]
    parent = np.array([-1, 0, 0, 1])
    inside = [rng.random(n) < 0.3 for n in size]
    start = np.concatenate([[0], size.cumsum()])
    inside = [np.logical_and.accumulate(some) for some in inside]
    found = feet(np.concatenate(lines), start, parent, np.concatenate(inside), ahead, slide, 0.15)
    slow = reference.feet(lines, parent, inside, ahead, slide, 0.15)
    own = [f - start[p] if p >= 0 else -1 for f, p in zip(found, parent, strict=True)]
    assert own == slow
