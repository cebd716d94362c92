"""What callers give is checked at the door: a PrunusError that names it, whatever it is.

Kernels check nothing: an index or a confidence out of range would end Python itself.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Any

import networkx
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

import prunus
from prunus import Parameters, PointCloud, PrunusError, Skeleton, search_graph, skeletonize
from prunus.model import CandidateGraph, RigidMotion
from prunus.model.branches import branches
from prunus.paper.confidence import ConstantScorer
from prunus.pipeline import follow
from tests.conftest import simulated


@cache
def whip() -> np.ndarray:
    """A trunk of 1.2 m: the smallest cloud that goes through the whole chain."""
    rng = np.random.default_rng(5)
    return np.column_stack([*rng.normal(0, 0.008, (2, 900)), rng.uniform(0, 1.2, 900)])


NODES = np.array([[0.0, 0, 0], [0, 0, 0.15], [0.02, 0, 0.3], [0, 0, 0.45]])
GRAPH = {
    "nodes": NODES,
    "edges": [(0, 1), (1, 2), (2, 3)],
    "confidence": [0.9, 0.8, 0.9],
    "base": 0,
}


# --- scorers -------------------------------------------------------------------------------------


PAPER = Parameters.paper().changed("search", K=20)


@dataclass(frozen=True)
class Own:
    """A scorer of one's own that gives what it is told."""

    gives: Callable[[int], Any]
    name: Any = "own"

    def __call__(self, candidates: CandidateGraph) -> Any:
        return self.gives(len(candidates.edges))


@dataclass(frozen=True)
class OwnJudge(Own):
    def judge(self, candidates: CandidateGraph) -> Any:
        return self.gives(len(candidates.edges))


def half(edges: int) -> np.ndarray:
    return np.full(edges, 0.5)


def fifths(edges: int) -> np.ndarray:
    return np.full((edges, 5), 0.2)


def one(edges: int, value: float) -> np.ndarray:
    """Good confidences but for the last."""
    return np.append(np.full(edges - 1, 0.9), value)


@pytest.mark.parametrize(
    ("gives", "says"),
    [
        (lambda e: one(e, 1.0000001), "holds 1.0000001; expected numbers from 0 to 1"),
        (lambda e: one(e, np.nextafter(1, 2)), "expected numbers from 0 to 1"),
        (lambda e: one(e, -1e-9), "holds -1e-09"),
        (lambda e: one(e, np.nan), "holds nan"),
        (lambda e: one(e, np.inf), "holds inf"),
        (lambda e: half(e).astype(np.float32) * 3, "holds 1.5"),
        (lambda e: half(e - 1), "shape .* expected"),
        (lambda e: half(e)[:, None], "shape .* expected"),
        (lambda e: 0.5, r"shape \(\); expected"),
        (lambda e: None, r"shape \(\); expected"),
        (lambda e: half(e).astype(complex), "complex128; expected numbers"),
        (lambda e: ["0.5"] * e, "text; expected numbers"),
        (lambda e: half(e) > 0, "truth values; expected numbers"),
        (lambda e: np.ma.masked_less(half(e), 1), "masked values"),
    ],
)
def test_a_confidence_that_is_none_is_refused(gives: Callable[[int], Any], says: str) -> None:
    with pytest.raises(PrunusError, match=f"scorer 'own': confidence: .*{says}"):
        skeletonize(whip(), params=PAPER, scorer=Own(gives))


@pytest.mark.parametrize(
    ("gives", "says"),
    [
        (half, "judge gave ndarray; expected two arrays"),
        (lambda e: (half(e), fifths(e), 1), "judge gave tuple; expected two"),
        (lambda e: (one(e, 2.0), fifths(e)), "confidence: holds 2"),
        (lambda e: (half(e), fifths(e)[:, :4]), r"category: shape .* expected \(\d+, 5\)"),
        (lambda e: (half(e), fifths(e)[1:]), "category: shape"),
        (lambda e: (half(e), fifths(e) * np.nan), "category: holds nan"),
        (lambda e: (half(e), fifths(e) * 4), "category: not all rows sum to 1"),
        (lambda e: (half(e), fifths(e) - 1), "category: holds -0.8"),
    ],
)
def test_categories_that_are_none_are_refused(gives: Callable[[int], Any], says: str) -> None:
    with pytest.raises(PrunusError, match=f"scorer 'own': {says}"):
        skeletonize(whip(), params=PAPER, scorer=OwnJudge(gives))


@pytest.mark.parametrize(
    ("scorer", "says"),
    [
        (lambda candidates: half(len(candidates.edges)), "function has no name"),
        (ConstantScorer, "the class ConstantScorer; expected an object of it"),
        (0.5, "float has no name"),
        ("cnn", "str has no name"),
        (object(), "object has no name"),
        (Own(half, name=None), "its name is None; expected text"),
    ],
)
def test_what_is_no_scorer_is_refused(scorer: Any, says: str) -> None:
    with pytest.raises(PrunusError, match=f"scorer.*{says}"):
        skeletonize(whip(), params=PAPER, scorer=scorer)


@pytest.mark.parametrize("kind", [np.float16, np.float32, np.float64, list])
@pytest.mark.slow
def test_a_scorer_may_give_any_kind_of_number(kind: Any) -> None:
    def gives(edges: int) -> Any:
        return [0.5] * edges if kind is list else half(edges).astype(kind)

    assert len(
        follow(PointCloud.from_xyz(whip()), params=PAPER, scorer=Own(gives)).graph.confidence
    )


def test_what_goes_wrong_in_a_scorer_is_its_own_affair() -> None:
    def gives(edges: int) -> Any:
        raise ZeroDivisionError("mine")

    with pytest.raises(ZeroDivisionError, match="mine"):
        skeletonize(whip(), params=PAPER, scorer=Own(gives))


# --- clouds, bases, seeds, parameters ------------------------------------------------------------


@dataclass
class Lazy:
    """An object of another library: a table, a tensor."""

    values: Any
    fails: type[Exception] | None = field(default=None)

    def __array__(self, dtype: Any = None, copy: Any = None) -> np.ndarray:
        if self.fails:
            raise self.fails("cannot be an array")
        return np.asarray(self.values, dtype)


NAMED = np.zeros(9, [("x", float), ("y", float), ("z", float)])
JUNK: list[Any] = [
    5, 1.5, True, "a", b"a", {}, {"a": 1}, object(), np.nan, [], [[]], [1, 2], [[1, 2], [3]],
    ["1", "2", "3"], [1, 2, None], [10**400] * 3, [[1, 2, 1e308 * 10]], np.zeros((2, 2, 3)), NAMED,
    np.full((4, 3), 1e300), np.zeros((4, 3), complex), np.zeros((4, 3), bool), range(2), {1, 2},
    np.ma.masked_array(np.zeros((4, 3)), mask=np.eye(4, 3)), (x for x in "abc"), Ellipsis,
    Lazy([1.0, 2]), Lazy(0, RuntimeError), np.zeros((4, 3), "M8[s]"), np.zeros((0, 3)), int,
]  # fmt: skip
"""What is no cloud, no base, no graph, no columns of a skeleton."""

SAMPLE = Skeleton.build(NODES, [-1, 0, 1, 2], [0, 0, 2, 2])
COLUMNS = {"xyz": NODES, "parent": [-1, 0, 1, 2], "label": [0, 0, 2, 2]}
DOORS: dict[str, Callable[[Any], Any]] = {
    "skeletonize": skeletonize,
    "base": lambda x: skeletonize(whip(), x),
    "params": lambda x: skeletonize(whip(), params=x),
    "nodes": lambda x: search_graph(**GRAPH | {"nodes": x}),
    "edges": lambda x: search_graph(**GRAPH | {"edges": x}),
    "confidence": lambda x: search_graph(**GRAPH | {"confidence": x}),
    "PointCloud.from_xyz": PointCloud.from_xyz,
    "PointCloud": lambda x: PointCloud(x, x),
    "rgb": lambda x: PointCloud.from_xyz(NODES, rgb=x),
    "turn": lambda x: PointCloud.from_xyz(NODES, turn=x),
    "frame": lambda x: PointCloud.from_xyz(NODES, x),
    "Skeleton.build": lambda x: Skeleton.build(x, [-1], [0]),
    "parent": lambda x: Skeleton.build(**COLUMNS | {"parent": x}),
    "label": lambda x: Skeleton.build(**COLUMNS | {"label": x}),
    "with_radius": SAMPLE.with_radius,
    "rotation": lambda x: RigidMotion(x, [0, 0, 0]),
    "Parameters.parse": Parameters.parse,
    "Parameters": lambda x: Parameters(search=x),
    "from_toml": Parameters.from_toml,
    "from_word": prunus.Label.from_word,
    "read_skeleton": prunus.read_skeleton,
    "read_cloud": prunus.read_cloud,
    "write_skeleton": lambda x: prunus.write_skeleton("never.json", x),
}
TAKEN = {
    ("params", "{}"), ("Parameters.parse", "{}"), ("Parameters", "{}"), ("base", "[1, 2, 1.5]"),
}  # fmt: skip
"""What is none of that but good: the defaults."""


@pytest.mark.parametrize("door", DOORS)
def test_junk_is_refused_at_every_door(door: str) -> None:
    for junk in JUNK:
        if (door, repr(junk)) in TAKEN:
            continue
        with pytest.raises(PrunusError):
            DOORS[door](junk)
            pytest.fail(f"{door} takes {junk!r}")


@pytest.mark.parametrize(
    "kind",
    [
        lambda xyz: xyz.tolist(),
        lambda xyz: xyz.astype(np.float32),
        lambda xyz: np.asfortranarray(xyz),
        lambda xyz: np.repeat(xyz, 2, axis=0)[::2],
        lambda xyz: xyz[::-1][::-1],
        lambda xyz: np.ma.masked_array(xyz),
        lambda xyz: Lazy(xyz),
        lambda xyz: xyz.astype(object),
        lambda xyz: np.frombuffer(xyz.tobytes()).reshape(-1, 3),  # read-only
    ],
)
def test_a_cloud_may_come_as_any_kind_of_array(kind: Callable[[np.ndarray], Any]) -> None:
    usual = PointCloud.from_xyz(whip())
    assert PointCloud.from_xyz(kind(whip())).xyz == pytest.approx(usual.xyz, abs=1e-6)


def test_whole_numbers_are_points_too() -> None:
    points = PointCloud.from_xyz(np.array([[0, 0, 0], [2, 4, 8]], np.uint8))
    assert points.to_input.apply(points.xyz).tolist() == [[0, 0, 0], [2, 4, 8]]


@pytest.mark.parametrize("seed", [0, 7, np.int64(7), np.uint8(7), np.array(7), 2**70])
def test_a_seed_is_any_whole_number(seed: Any) -> None:
    assert search_graph(**GRAPH, seed=seed).score > 0


@pytest.mark.parametrize("seed", [-1, 1.0, "7", None, True, np.True_, [7], np.float64(7), b"7"])
def test_what_is_no_seed_is_refused(seed: Any) -> None:
    for door in (lambda: search_graph(**GRAPH, seed=seed), lambda: skeletonize(whip(), seed=seed)):
        with pytest.raises(PrunusError, match=r"seed: .*expected a whole number from 0"):
            door()


def test_parameters_are_checked_again() -> None:
    paper = Parameters.paper()
    crooked = paper.model_copy(update={"search": paper.search.model_copy(update={"K": -3})})
    with pytest.raises(PrunusError, match=r"search.K: .* found -3"):
        search_graph(**GRAPH, params=crooked)


# --- search_graph --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"edges": [(0, 1), (1, 1), (2, 3)]}, "edges: one joins a node to itself"),
        ({"edges": [(0, 1), (-1, 2), (2, 3)]}, "edges: holds -1 to 3; expected 0 to 3"),
        ({"edges": np.array([(0, 1), (1, 2), (2, 2**40)])}, "edges: holds 0 to 1099511627776"),
        ({"edges": np.full((3, 2), 2**64 - 1, np.uint64)}, "edges: holds 1844674.*of int64"),
        ({"edges": [(0.0, 1), (1, 2), (2, 3)]}, "edges: float64; expected integers"),
        ({"edges": [], "confidence": []}, "tips: none found"),
        ({"edges": [], "confidence": [], "tips": [3]}, r"no tree was found: .*\(0 of 0 edges"),
        ({"nodes": NODES * [1, 1, 0]}, "joins two nodes in the same place"),
        ({"nodes": NODES * 1e-9}, "joins two nodes in the same place"),
        ({"nodes": NODES * np.nan}, "4 of 4 points hold NaN"),
        ({"confidence": [0.9, 1.0000001, 0.9]}, "confidence: holds 0.9 to 1.0000001; expected 3"),
        ({"confidence": "0.9"}, r"confidence: shape \(\)"),
        ({"base": 4}, "base: holds 4 to 4"),
        ({"base": 0.0}, "base: float64; expected integers"),
        ({"base": None}, "base: objects; expected integers"),
        ({"base": True}, "base: truth values; expected integers"),
        ({"base": [0]}, r"base: shape \(1, 1\)"),
        ({"tips": np.ones(4, bool)}, "tips: truth values"),
        ({"tips": [[3]]}, "tips: shape"),
        ({"tips": 3}, "tips: shape"),
        ({"confidence": [0.0, 0.0, 0.0], "tips": [3]}, "no tree was found: nothing that pays"),
    ],
)
def test_a_graph_that_is_none_is_refused(change: dict[str, Any], says: str) -> None:
    with pytest.raises(PrunusError, match=says):
        search_graph(**GRAPH | change)


@given(data=st.data())
@settings(max_examples=60, deadline=None)
def test_any_graph_gives_a_tree_or_a_refusal(data: st.DataObject) -> None:
    """Loops, pieces, doubles, indices out of range, confidences at and beyond the ends."""
    count = data.draw(st.integers(1, 7))
    edges = data.draw(st.lists(st.tuples(*[st.integers(-1, count)] * 2), max_size=10))
    value = st.sampled_from([0.0, 1.0, 0.5, 1e-300, 1 - 1e-16, 1 + 1e-15, -0.0, np.nan])
    given_ = {
        "nodes": data.draw(arrays.arrays(float, (count, 3), elements=st.floats(-1, 1))),
        "edges": edges,
        "confidence": data.draw(st.lists(value, min_size=len(edges), max_size=len(edges))),
        "base": data.draw(st.integers(-1, count)),
        "tips": data.draw(st.none() | st.lists(st.integers(0, count), max_size=4)),
    }
    try:
        found = search_graph(**given_, params={"search": {"K": 20}})
    except PrunusError:
        return
    assert networkx.is_arborescence(found.skeleton.to_networkx())
    assert {tuple(sorted(pair)) for pair in found.edges.tolist()} <= {
        tuple(sorted(pair)) for pair in edges
    }


def test_a_graph_too_large_to_search_is_refused_before_the_memory_is_full() -> None:
    side = np.arange(70)
    nodes = np.stack(np.meshgrid(side, side), axis=-1).reshape(-1, 2) * 0.1
    flat = np.column_stack([nodes[:, 0], np.zeros(4900), nodes[:, 1]])
    edges = [(n, n + 70) for n in range(4900 - 70)]
    with pytest.raises(PrunusError, match=r"ways to 4829 tips over 4830 edges take .* GB"):
        search_graph(flat, edges, np.ones(len(edges)), 0, tips=np.arange(71, 4900))


def test_parameters_of_a_method_that_searches_no_graph_are_refused() -> None:
    with pytest.raises(PrunusError, match=r"searches no graph; expected .*Parameters.paper\(\)"):
        search_graph(**GRAPH, params=Parameters())


def test_a_scorer_of_edges_is_refused_by_a_method_that_scores_none() -> None:
    with pytest.raises(PrunusError, match="scorer: of no use to the method"):
        skeletonize(whip(), scorer=Own(np.ones))


# --- results -------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def result() -> prunus.Result:
    truth, cloud = simulated(4)
    return skeletonize(cloud, truth.xyz[0], params={"input": {"points": 15_000}})


def test_parameters_may_be_dicts(result: prunus.Result) -> None:
    assert result.params == Parameters().changed("input", points=15_000)


def test_a_result_says_what_it_is_in_a_line(result: prunus.Result) -> None:
    leaders = len(branches(result.in_house, prunus.Label.LEADER))
    assert repr(result).startswith(f"Result({leaders} leaders, ")
    trust = "unknown" if result.trust is None else f"{result.trust.tree:.2f}"
    assert repr(result).endswith(f" side branches, trust {trust})")


def test_the_skeleton_has_the_radii_of_the_refined_one(result: prunus.Result) -> None:
    known = result.refined.radius_at(result.skeleton.superpoint)
    assert np.isfinite(known).mean() > 0.5
    assert np.array_equal(result.skeleton.radius, known, equal_nan=True)


def test_colours_are_kept_or_refused_never_cut_off() -> None:
    kept = PointCloud.from_xyz(NODES, rgb=[[0, 128, 255]] * 4)
    assert kept.rgb is not None and kept.rgb.dtype == np.uint8
    for wrong in ([[0, 128, 256]] * 4, [[-1, 0, 0]] * 4, np.full((4, 3), 0.5), [[1, 2, 3]]):
        with pytest.raises(PrunusError, match="rgb: "):
            PointCloud.from_xyz(NODES, rgb=wrong)


@pytest.mark.parametrize("turn", [np.eye(3) * 2, np.diag([1, 1, -1]), np.full((3, 3), np.nan)])
def test_a_turn_that_is_no_rotation_is_refused(turn: np.ndarray) -> None:
    with pytest.raises(PrunusError, match="turn: no rotation"):
        PointCloud.from_xyz(NODES, turn=turn)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"parent": [-1, 0, 0.5, 1]}, "parent: float64; expected integers"),
        ({"label": [0, 0, 258, 2]}, "label: holds 0 to 258; expected integers of int8"),
        ({"label": ["trunk"] * 4}, "label: text"),
        ({"confidence": ["1"] * 4}, "confidence: text"),
        ({"radius": [0.1]}, r"radius: shape \(1,\); expected \(4,\)"),
        ({"superpoint": [0.0, 1, 2, 3]}, "superpoint: float64"),
    ],
)
def test_columns_are_never_rounded_to_fit(change: dict[str, Any], says: str) -> None:
    with pytest.raises(PrunusError, match=says):
        Skeleton.build(**COLUMNS | change)


def test_a_skeleton_is_only_replaced_by_a_checked_one() -> None:
    with pytest.raises(PrunusError, match="parent"):
        replace(SAMPLE, parent=np.array([-1, 5, 1, 2]))
