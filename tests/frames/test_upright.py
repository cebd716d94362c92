"""Which way up a tree is surest."""

from pathlib import Path

import numpy as np
import pytest

from prunus.frames.scan import open_scan
from prunus.frames.upright import surest_frame
from prunus.model import FRAMES, Floats
from tests.conftest import simulated

UP = ["z-up", "optical", "y-up", "x-up", "x-down", "z-down"]
"""A frame for each axis that may be up."""


@pytest.fixture(scope="module")
def points() -> Floats:
    cloud = simulated(4)[1]
    return np.asarray(cloud.to_input.apply(cloud.xyz))


@pytest.mark.parametrize("frame", UP)
@pytest.mark.slow
def test_a_tree_is_surest_in_the_frame_it_stands_in(points: Floats, frame: str) -> None:
    others = [name for name in UP if name != frame]
    assert surest_frame(points @ FRAMES[frame], [*others, frame]) == frame


def test_where_there_is_no_tree_the_first_frame_is_kept() -> None:
    ball = np.random.default_rng(0).normal(size=(3000, 3))
    ball /= 2 * np.linalg.norm(ball, axis=1)[:, None]
    for first in ("z-up", "optical"):
        assert surest_frame(0.01 * ball, [first, "y-up"]) == first


def test_a_frame_that_was_asked_for_is_taken(points: Floats, tmp_path: Path) -> None:
    np.save(tmp_path / "tree.npy", points)
    assert open_scan(tmp_path / "tree.npy", "optical").frame == "optical"
    assert open_scan(tmp_path / "tree.npy").frame == "z-up"
