import numpy as np
import pytest

from prunus.field.votes import APART_M, PointField, gather_votes
from prunus.model import Role


def field_of(xyz, axis, role=Role.STEM):
    """A field that knows the axis of every voxel."""
    chance = np.full((len(xyz), len(Role)), 0.02)
    chance[:, role] = 0.9
    return PointField(
        xyz=xyz,
        count=np.full(len(xyz), 4),
        role=chance,
        offset=axis - xyz,
        radius=np.full(len(xyz), 0.05),
        toward_foot=np.tile([0.0, 0.0, -1.0], (len(xyz), 1)),
        foot=np.zeros((len(xyz), 2)),
    )


@pytest.fixture(scope="module")
def trunk():
    """The front half of the mantle of an upright trunk, and its axis."""
    height, turn = np.meshgrid(np.arange(0, 1, 0.02), np.linspace(np.pi, 2 * np.pi, 9))
    x, y = 0.05 * np.cos(turn), 0.05 * np.sin(turn)
    mantle = np.stack([x, y, height], axis=-1).reshape(-1, 3)
    return mantle, mantle * [0, 0, 1]


def test_one_side_of_a_fat_trunk_becomes_one_thread_on_its_axis(trunk):
    threads = gather_votes(field_of(*trunk))
    assert np.abs(threads.xyz[:, :2]).max() < 1e-9
    assert 1.0 / 0.03 < len(threads) < 1.0 / (0.9 * APART_M)
    assert threads.role.argmax(axis=1) == pytest.approx(Role.STEM)
    assert threads.radius == pytest.approx(0.05)


def test_what_is_no_wood_has_no_vote(trunk):
    assert len(gather_votes(field_of(*trunk, role=Role.NO_WOOD))) == 0


def test_a_lonely_voxel_is_noise(trunk):
    mantle, axis = trunk
    far = np.array([[3.0, 3.0, 3.0]])
    threads = gather_votes(field_of(np.concatenate([mantle, far]), np.concatenate([axis, far])))
    assert threads.xyz.max() < 2


def test_the_order_of_the_voxels_does_not_matter(trunk):
    mantle, axis = trunk
    order = np.random.default_rng(0).permutation(len(mantle))
    one, other = (
        gather_votes(field_of(mantle, axis)),
        gather_votes(field_of(mantle[order], axis[order])),
    )
    by_height = [np.sort(threads.xyz[:, 2]) for threads in (one, other)]
    assert by_height[0] == pytest.approx(by_height[1])
