"""Where lines leave their parents, against the slow twin and on a drawn case."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from prunus.model import Floats
from prunus.refine.feet import Bools, feet, within_parents
from tests import reference

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
    assert left(slanting, inside, [0.01, 10.0], ANY) == 10, "5 cm lower than it started"
    assert left(slanting, inside, [10.0, 0.01], ANY) == 15, "where it started"


def test_a_line_that_bends_leaves_at_a_usual_angle() -> None:
    inside = np.zeros(42, np.bool_)
    inside[31:34] = True
    steep = (np.arctan2(0.03, 0.05), 0.01)
    assert left(ASIDE, inside, [10.0, 10.0], steep) == 10, "3 cm aside, 5 cm up"


ANY = (1.0, 1000.0)


def left(line: Floats, inside: Bools, err: list[float], usual: tuple[float, float]) -> int:
    """The station of `UP` from which a line leaves."""
    lines, home = np.concatenate([UP, line]), np.array([UP[0], line[0]])
    found = feet(
        lines, START, PARENT, inside, home=home, usual=np.array([ANY, usual]),
        err=np.array([err, err]), ahead=6, slide=8,
    )  # fmt: skip
    assert found[0] == -1
    return int(found[1])


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
    home = rng.normal(0, 0.05, (4, 3))
    usual, err = rng.uniform(0.2, 2.0, (4, 2)), rng.uniform(0.01, 0.1, (4, 2))
    found = feet(
        np.concatenate(lines), start, parent, np.concatenate(inside), home=home, usual=usual,
        err=err, ahead=ahead, slide=slide,
    )  # fmt: skip
    slow = reference.feet(lines, parent, inside, home, usual, err, ahead, slide)
    own = [f - start[p] if p >= 0 else -1 for f, p in zip(found, parent, strict=True)]
    assert own == slow
