"""Wires among wood: what is straight, level and long."""

import numpy as np
import pytest

from prunus.model import Floats, PointCloud
from prunus.params import Parameters
from prunus.stages import superpoints
from prunus.stages.superpoints import find_superpoints
from prunus.stages.wires import on_wires


def line(start: list[float], end: list[float], rng: np.random.Generator, count: int) -> Floats:
    share = rng.random((count, 1))
    points = np.array(start) * (1 - share) + np.array(end) * share
    return np.asarray(points + rng.normal(0, 0.003, (count, 3)))


def along(start: list[float], end: list[float], count: int) -> Floats:
    step = np.array(end) - start
    return np.tile(step / np.linalg.norm(step), (count, 1))


def test_a_wire_is_found_and_the_leaders_that_cross_it_stay(rng: np.random.Generator) -> None:
    wire = line([-1.5, 0, 1], [1.5, 0.05, 1.02], rng, 400)
    leaders = [line([x, 0, 0], [x, 0, 2], rng, 200) for x in np.arange(-1, 1.1, 0.25)]
    xyz = np.concatenate([wire, *leaders])
    directions = np.concatenate(
        [along([0, 0, 0], [1, 0, 0], 400), along([0, 0, 0], [0, 0, 1], 200 * len(leaders))]
    )
    found = on_wires(xyz, directions, rng)
    assert found[:400].mean() > 0.95
    assert not found[400:].any()


def test_a_support_that_waves_or_is_short_is_no_wire(rng: np.random.Generator) -> None:
    x = np.linspace(-1.2, 1.2, 500)
    waving = np.column_stack([x, 0 * x, 0.6 + 0.05 * np.sin(4 * x)])
    assert not on_wires(waving, along([0, 0, 0], [1, 0, 0], 500), rng).any()
    short = line([-0.6, 0, 0.6], [0.6, 0, 0.6], rng, 500)
    assert not on_wires(short, along([0, 0, 0], [1, 0, 0], 500), rng).any()
    assert not on_wires(np.zeros((0, 3)), np.zeros((0, 3)), rng).any()


def test_few_superpoints_lie_on_a_thick_wire_away_from_wood(
    rng: np.random.Generator, monkeypatch: pytest.MonkeyPatch
) -> None:
    trunk = line([0, 0, 0], [0, 0, 2], rng, 3000) + rng.normal(0, 0.012, (3000, 3))
    wire = line([-1.5, 0, 1], [1.5, 0, 1], rng, 3000) + rng.normal(0, 0.012, (3000, 3))
    cloud = PointCloud.from_xyz(np.concatenate([trunk, wire]))
    under = find_superpoints(cloud, Parameters.learned().superpoints, rng)
    monkeypatch.setattr(superpoints, "on_wires", lambda xyz, *_: np.zeros(len(xyz), np.bool_))
    blind = find_superpoints(cloud, Parameters.learned().superpoints, rng)
    left, all_of_it = (np.abs(one.xyz[:, 0]) > 0.12 for one in (under, blind))
    assert left.sum() < all_of_it.sum() / 3
    assert (~left).sum() > 10
