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
    assert cloud.sample_evenly(None, rng) is cloud
    assert cloud.sample_evenly(50, rng) is cloud


def test_a_trunk_scanned_much_denser_leaves_its_share_to_the_twigs(
    rng: np.random.Generator,
) -> None:
    trunk, twigs = (
        rng.random((90_000, 3)) * [0.1, 0.1, 1],
        1 + rng.random((10_000, 3)) * [1, 0.1, 1],
    )
    cloud = PointCloud.from_xyz(np.concatenate([trunk, twigs]))
    drawn = cloud.sample_evenly(10_000, rng)
    place = cloud.to_input.apply(drawn.xyz)
    assert (place[:, 0] > 0.9).sum() > 3 * 1000
    assert len(np.unique(drawn.xyz, axis=0)) == 10_000


@pytest.mark.parametrize("count", [500, 20_000, 200_000])
def test_half_of_an_even_cloud_is_drawn_evenly(rng: np.random.Generator, count: int) -> None:
    cloud = PointCloud.from_xyz(rng.random((count, 3)) * [1, 1, 0.1])
    drawn = cloud.sample_evenly(count // 2, rng)
    assert len(drawn) == count // 2
    assert np.abs(drawn.xyz.mean(axis=0)).max() < 0.05


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
