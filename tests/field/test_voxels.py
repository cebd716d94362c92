from itertools import pairwise

import numpy as np
import pytest

from prunus.field.voxels import FEATURES, LEVELS, NEIGHBOURS, VOXEL_M, voxels_of


@pytest.fixture(scope="module")
def cloud():
    rng = np.random.default_rng(0)
    line = np.linspace(0, 1, 2000)[:, None] * [0.3, 0.2, 1.0]
    return np.concatenate([line + rng.normal(0, 0.01, line.shape), rng.random((300, 3))])


def test_each_point_lies_in_its_voxel(cloud):
    voxels = voxels_of(cloud)
    low = voxels.corner + voxels.cells[voxels.of_point] * VOXEL_M
    assert (cloud >= low - 1e-9).all() and (cloud <= low + VOXEL_M + 1e-9).all()
    assert voxels.count.sum() == len(cloud)


def test_means_and_covariances_are_those_of_the_points(cloud):
    voxels = voxels_of(cloud)
    fullest = int(voxels.count.argmax())
    own = cloud[voxels.of_point == fullest]
    assert voxels.xyz[fullest] == pytest.approx(own.mean(axis=0))
    spread = np.cov(own.T, bias=True) / VOXEL_M**2
    assert voxels.spread[fullest] == pytest.approx(spread[np.triu_indices(3)])


def test_neighbours_are_those_that_a_dictionary_finds(cloud):
    voxels = voxels_of(cloud)
    for level in voxels.levels:
        row_of = {tuple(cell): row for row, cell in enumerate(level.cells.tolist())}
        none = len(level.cells)
        for row, cell in enumerate(level.cells):
            expected = [row_of.get(tuple(near), none) for near in (cell + NEIGHBOURS).tolist()]
            assert level.neighbours[row].tolist() == expected


def test_children_and_parents_agree(cloud):
    levels = voxels_of(cloud).levels
    assert len(levels) == LEVELS
    for fine, coarse in pairwise(levels):
        assert (coarse.cells[fine.parent] == fine.cells >> 1).all()
        for row, children in enumerate(fine.children):
            held = np.flatnonzero(fine.parent == row)
            assert sorted(children[children < len(fine.cells)]) == held.tolist()


def test_moving_the_cloud_by_whole_voxels_changes_no_feature(cloud):
    here, there = voxels_of(cloud), voxels_of(cloud + VOXEL_M * np.array([64, -32, 0]))
    assert here.features().shape == (len(here.xyz), FEATURES)
    assert there.features() == pytest.approx(here.features(), abs=1e-4)


def test_one_point_is_one_voxel():
    voxels = voxels_of(np.zeros((1, 3)))
    assert voxels.count.tolist() == [1]
    assert [len(level.cells) for level in voxels.levels] == [1] * LEVELS
