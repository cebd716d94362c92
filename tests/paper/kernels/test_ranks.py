"""Rank, with ties averaged."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prunus.paper.kernels.ranks import average_ranks
from tests import reference


def ranks(values: list[float], copies: list[int]) -> list[float]:
    out = np.empty(len(values))
    average_ranks(np.array(values, np.float64), np.array(copies), out)
    return out.tolist()


def test_the_papers_example() -> None:
    assert ranks([4, 5, 5, 3, 7], [1] * 5) == pytest.approx([2 / 5, 7 / 10, 7 / 10, 1 / 5, 1])


@settings(deadline=None, max_examples=60)
@given(drawn=st.lists(st.tuples(st.integers(0, 6), st.integers(1, 3)), min_size=1, max_size=80))
def test_copies_count_as_often_as_they_stand(drawn: list[tuple[int, int]]) -> None:
    values = [float(value) for value, _ in drawn]
    copies = [many for _, many in drawn]
    spelled = [value for value, many in zip(values, copies, strict=True) for _ in range(many)]
    slow = dict(zip(spelled, reference.average_ranks(spelled), strict=True))
    assert ranks(values, copies) == pytest.approx([slow[value] for value in values])
