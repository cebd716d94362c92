"""What is no tree is refused with the reason; what may be none is said."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from prunus.errors import NoTreeError
from prunus.frames.plausible import Evidence
from prunus.model import FRAMES, Floats, PointCloud, Skeleton
from prunus.params import Parameters
from prunus.pipeline import follow, skeletonize
from tests.conftest import field_scan, simulated


def tree_points(seed: int = 4) -> Floats:
    """The points of a simulated tree, 2.3 m high."""
    cloud = simulated(seed)[1]
    return np.asarray(cloud.to_input.apply(cloud.xyz))


def wall() -> Floats:
    rng = np.random.default_rng(7)
    return np.column_stack([*rng.uniform(0, 1.2, (2, 9000)), rng.normal(0, 0.002, 9000)])[
        :, [0, 2, 1]
    ]


def ball() -> Floats:
    rng = np.random.default_rng(7)
    ways = rng.normal(size=(9000, 3))
    return np.asarray(0.4 * ways / np.linalg.norm(ways, axis=1)[:, None])


def twigs() -> Floats:
    """A heap of twigs of 10 cm, any way up."""
    rng = np.random.default_rng(7)
    middle = rng.uniform(-1, 1, (1200, 1, 3)) * [0.8, 0.35, 0.4]
    way = rng.normal(size=(1200, 1, 3))
    way /= np.linalg.norm(way, axis=2, keepdims=True)
    along = rng.uniform(-0.05, 0.05, (1200, 20, 1))
    return np.asarray((middle + way * along).reshape(-1, 3))


def solid(half: float, count: int) -> Floats:
    return np.random.default_rng(7).uniform(-half, half, (count, 3))


def utm_in_single_precision() -> Floats:
    far = np.array([398_765.0, 5_345_678.0, 412.0])
    return np.asarray((tree_points() + far).astype(np.float32))


NO_TREES: dict[str, tuple[Callable[[], Floats], str]] = {
    "one point": (lambda: np.zeros((1, 3)), "all points lie in one place"),
    "one place": (lambda: np.full((900, 3), 7.5), "all points lie in one place"),
    "a level line": (lambda: np.linspace(0, 1, 3000)[:, None] * [1, 0.2, 0], "on one line"),
    "a slanting line": (lambda: np.linspace(0, 2, 3000)[:, None] * [1, 1, 1.5], "on one line"),
    "a floor": (lambda: wall()[:, [0, 2, 1]], "lie in one plane"),
    "a wall": (wall, "lie in one plane"),
    "a ball": (ball, "surface or a heap|no wood can be followed"),
    "noise": (lambda: solid(1.0, 9000), "neighbouring points are about 0.0[4-8]"),
    "a solid": (lambda: solid(0.15, 5000), "surface or a heap"),
    "twigs": (twigs, "no wood can be followed|but a heap"),
    "a twig": (lambda: tree_points() * 0.025, "0.0.* x 0.0.* m, too little: is the unit right"),
    "20 m high": (lambda: tree_points() * 8.5, "points are about .* m apart in a cloud of 13.* m"),
    "200 m high": (lambda: tree_points() * 85, "a denser cloud, or another unit"),
    "sparse": (lambda: tree_points()[::70], "points are about .* m apart"),
    "single precision": (utm_in_single_precision, "steps of 0.5 m: single precision"),
}


@pytest.mark.parametrize("kind", NO_TREES)
@pytest.mark.slow
def test_what_is_no_tree_is_refused_with_the_reason(kind: str) -> None:
    points, reason = NO_TREES[kind]
    with pytest.raises(NoTreeError, match=reason):
        skeletonize(points())


def test_what_was_found_is_there_for_experiments_tree_or_not() -> None:
    found = follow(PointCloud.from_xyz(wall()), params=Parameters.paper().changed("search", K=20))
    assert Evidence.of(found).linear < 0.25


@pytest.mark.parametrize(
    "turn",
    [[0, 2, 1], [2, 1, 0], [1, 2, 0]],
    ids=["depth is up", "the row is up", "turned round"],
)
def test_a_tree_that_lies_on_its_side_is_said_or_refused(turn: list[int]) -> None:
    try:
        review = skeletonize(tree_points()[:, turn]).review
    except NoTreeError as error:
        review = [str(error)]
    assert review


def test_a_tree_as_it_stands_is_not_doubted(scanned: tuple[Skeleton, PointCloud]) -> None:
    truth, cloud = scanned
    result = skeletonize(cloud, truth.xyz[0])
    assert Evidence.of(result).doubts() == []
    assert not any("--frame" in line or "base" in line for line in result.review)


GOOD = Evidence(length=9.0, across=0.3, explained=0.9, linear=0.7, rise=0.8)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"length": 0.0}, "found: no wood can be followed from its base"),
        ({"length": 0.4}, "0.40 m of wood; expected at least 0.5 m"),
        ({"across": 0.001}, "but a straight line"),
        ({"step": 0.1}, "no tree was found$"),
        ({"linear": 0.1}, "but a surface or a heap"),
        ({"sure": 0.15}, "but a heap: what was followed is not like branches"),
        ({"wood": 0.04}, "but what is 4% likely bare wood: a surface, a heap or leaves"),
        ({"explained": 0.05}, "explain 5% of the points"),
        ({"explained": 0.4, "trunk": False}, "60% of the points are not .* no trunk is in view"),
    ],
)
def test_each_evidence_alone_is_enough(change: dict[str, Any], reason: str) -> None:
    GOOD.check()
    with pytest.raises(NoTreeError, match=reason):
        replace(GOOD, **change).check()


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"step": 0.03}, "steps of 0.03 m: single precision, or rounded"),
        ({"linear": 0.35}, "not like branches"),
        ({"trunk": False}, "no trunk is in view: is Z up"),
        ({"rise": 0.2}, "hardly rise"),
    ],
)
def test_what_is_only_odd_is_a_doubt(change: dict[str, Any], says: str) -> None:
    odd = replace(GOOD, **change)
    odd.check()
    assert says in " ".join(odd.doubts())


def test_where_much_was_taken_away_the_message_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("prunus.frames.plausible.LEAST_EXPLAINED", 1.0)
    with pytest.raises(NoTreeError, match=r"% of the scan was left out .*--no-isolate"):
        skeletonize(field_scan(4).xyz)


LYING = [name for name, turn in FRAMES.items() if turn[2, 2] < 0.5]
"""The frames in which another axis than Z is up."""


@pytest.mark.parametrize("frame", LYING)
@pytest.mark.slow
def test_a_tree_in_another_frame_than_was_said_is_refused_and_its_own_is_named(frame: str) -> None:
    with pytest.raises(NoTreeError) as told:
        skeletonize(tree_points() @ FRAMES[frame])
    up = FRAMES[frame][2]
    named = [name for name in FRAMES if f"--frame {name}" in str(told.value)]
    assert any(np.allclose(FRAMES[name][2], up) for name in named), str(told.value)


def test_a_tree_that_stands_does_not_lie() -> None:
    assert not Evidence.of(follow(PointCloud.from_xyz(tree_points()))).lies
