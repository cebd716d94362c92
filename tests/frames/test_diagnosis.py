"""Why no tree was found, by the evidence in the cloud."""

import numpy as np
import pytest

from prunus.errors import NoTreeError, PrunusError
from prunus.frames.diagnosis import coarseness, explaining, spacing, spread, why_no_tree
from prunus.model import Floats, PointCloud


def rods(upright: int, count: int = 3000) -> Floats:
    """Two rows of six sticks of 1 m that run along one axis, 20 cm apart."""
    rng = np.random.default_rng(3)
    points = rng.normal(0, 0.006, (count, 3))
    points[:, upright] = rng.uniform(0, 1, count)
    for axis, rods_beside in ((upright + 1, 6), (upright + 2, 2)):
        points[:, axis % 3] += rng.integers(rods_beside, size=count) * 0.2
    return points


@pytest.mark.parametrize(
    ("points", "reason"),
    [
        (np.full((40, 3), 3.0), "all points lie in one place"),
        (rods(2) * 0.05, "too little: is the unit right"),
        (np.linspace(-1, 1, 500)[:, None] * [0.3, 1, 0.2], "all points lie on one line"),
        (np.random.default_rng(1).uniform(0, 2, (5000, 3)) * [1, 1, 0.002], "in one plane"),
        (np.round(rods(2) * 4) / 4, "in steps of 0.25 m: single precision"),
        (rods(2, 100) * 3, "neighbouring points are about .* m apart in a cloud of .* m"),
        (rods(2, 60_000) * [1, 1, 14], "13.8 m: is the unit right"),
        (rods(1), "lie on its side.*try --frame optical"),
        (np.random.default_rng(1).uniform(0, 0.4, (9000, 3)), "hardly anything in it is like a"),
        (rods(2), "expected one dormant tree, standing, Z up, in metres"),
    ],
)
def test_the_first_thing_that_is_wrong_is_named(points: Floats, reason: str) -> None:
    cloud = PointCloud.from_xyz(points)
    with pytest.raises(NoTreeError, match=f"nothing; .*{reason}"), explaining(cloud):
        raise NoTreeError("nothing")


def test_a_frame_is_named_as_the_file_has_it() -> None:
    """Read as optical though Z is up: what helps is `z-up`, not another turn from there."""
    lying = PointCloud.from_xyz(rods(2), "optical")
    assert "--frame z-up" in why_no_tree(lying)
    assert "--frame" in why_no_tree(PointCloud.from_xyz(rods(1), "optical"))  # what is expected
    assert "try --frame" not in why_no_tree(PointCloud.from_xyz(rods(1), "optical"))


def test_other_errors_pass_unexplained() -> None:
    with pytest.raises(PrunusError, match=r"^wrong$"), explaining(PointCloud.from_xyz(rods(2))):
        raise PrunusError("wrong")


def test_steps_spacing_and_spread_are_what_they_are() -> None:
    grid = np.stack(np.meshgrid(*[np.arange(8) * 0.03] * 3), axis=-1).reshape(-1, 3)
    assert coarseness(PointCloud.from_xyz(grid)) == pytest.approx(0.03)
    assert coarseness(PointCloud.from_xyz(rods(2))) < 1e-3
    assert coarseness(PointCloud.from_xyz(rods(2) * [0.03, 0.03, 1])) < 1e-3  # slender, at 0
    assert 0.03 <= spacing(grid) < 0.03 * 2**0.5
    assert spread(np.array([[0.0, 0, 0], [2, 0, 0]])).tolist() == [0, 0, 1]
