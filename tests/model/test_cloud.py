"""Clouds: frames, local origins, sampling."""

import numpy as np
import pytest

from prunus.errors import PrunusError
from prunus.model import PointCloud


def test_an_optical_cloud_stands_up(rng: np.random.Generator) -> None:
    xyz = rng.normal(size=(10, 3))
    cloud = PointCloud.from_xyz(xyz, "optical")
    down, depth = xyz[:, 1], xyz[:, 2]
    assert np.ptp(cloud.xyz[:, 2] + down) == pytest.approx(0, abs=1e-5)
    assert np.ptp(cloud.xyz[:, 1] - depth) == pytest.approx(0, abs=1e-5)


def test_the_way_back_keeps_millimetres_of_utm_coordinates(rng: np.random.Generator) -> None:
    xyz = rng.uniform(-2, 2, (100, 3)) + np.array([612_345.678, 5_123_456.789, 321.0])
    cloud = PointCloud.from_xyz(xyz)
    assert np.abs(cloud.xyz).max() < 5
    assert np.abs(cloud.to_input.apply(cloud.xyz) - xyz).max() < 2e-6


def test_a_sample_is_some_of_the_points_each_once(rng: np.random.Generator) -> None:
    cloud = PointCloud.from_xyz(rng.normal(size=(50, 3)), rgb=np.zeros((50, 3), np.uint8))
    drawn = cloud.sample(20, rng)
    assert len(np.unique(drawn.xyz, axis=0)) == 20
    assert drawn.rgb is not None and len(drawn.rgb) == 20
    assert cloud.sample(None, rng) is cloud
    assert cloud.sample(50, rng) is cloud


@pytest.mark.parametrize(
    ("xyz", "message"),
    [
        (np.zeros((0, 3)), "holds no points"),
        (np.zeros((4, 2)), r"shape \(4, 2\); expected \(N, 3\)"),
        ([[0, 0, np.nan], [0, 0, np.inf], [1, 1, 1]], "2 of 3 points hold NaN or infinity"),
        ([["a", "b", "c"]], "the cloud: text; expected numbers"),
    ],
)
def test_bad_points_are_refused(xyz: object, message: str) -> None:
    with pytest.raises(PrunusError, match=message):
        PointCloud.from_xyz(xyz)


def test_an_unknown_frame_is_refused() -> None:
    with pytest.raises(PrunusError, match="unknown frame 'y-under'; expected one of"):
        PointCloud.from_xyz(np.zeros((1, 3)), "y-under")
