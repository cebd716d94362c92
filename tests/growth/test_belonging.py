"""Of a row each tree owns its own wood, however it is seen; of one tree nobody is asked."""

import itertools
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from prunus.errors import PrunusError
from prunus.field import network
from prunus.field.votes import Threads
from prunus.growth import belonging
from prunus.growth.belonging import SUREST, likeliest, likely_part, log_odds
from prunus.growth.feet import find_feet
from prunus.growth.graph import ThreadGraph, join_threads
from prunus.growth.grow import Orchard
from prunus.growth.tokens import FEATURES, TOKEN_M, Tokens
from prunus.growth.ways import cheapest
from prunus.model import Ints
from prunus.model.rotations import turned
from tests.growth.drawn import TEXTBOOK, Piece, threads_of


def beside(pieces: list[Piece], x: float, y: float = 0.0) -> list[Piece]:
    return [(role, [(a + x, b + y, c) for a, b, c in way], r) for role, way, r in pieces]


def row_of(apart: float, trees: int = 2, seed: int = 1) -> tuple[Threads, Ints]:
    """The threads of trees side by side, and the tree of each node."""
    pieces = [beside(TEXTBOOK, apart * number) for number in range(trees)]
    threads = threads_of(list(itertools.chain(*pieces)), seed)
    return threads, np.repeat(np.arange(trees), len(threads) // trees)


def graph_and_feet(apart: float) -> tuple[ThreadGraph, Ints]:
    graph = join_threads(row_of(apart)[0])
    feet = find_feet(graph)
    assert len(feet) == 2
    return graph, feet


def share_owned(seen: Threads, true: Ints) -> float:
    """The share of nodes given to the tree that is truly theirs."""
    graph = join_threads(seen)
    feet = find_feet(graph)
    stands_on = {int(foot): true[foot] for foot in feet}
    return float(np.mean([stands_on.get(int(f)) == t for f, t in
                          zip(likeliest(graph, feet), true, strict=True)]))  # fmt: skip


@pytest.mark.parametrize("seed", [None, 1])
def test_of_a_single_foot_nothing_changes_and_no_network_is_asked(seed: int | None) -> None:
    graph = join_threads(threads_of(TEXTBOOK, seed))
    feet = find_feet(graph)
    assert len(feet) == 1
    given = likeliest(graph, feet, Path("there-is-none.onnx"))
    assert np.array_equal(given, cheapest(graph, feet))


def test_an_orchard_of_what_is_said_to_be_one_tree_asks_nobody() -> None:
    def never(graph: ThreadGraph, feet: Ints) -> Ints:
        raise AssertionError

    threads, _ = row_of(2.0)
    orchard = Orchard.of(join_threads(threads), alone=True, own=never)
    assert len(orchard.feet) == 1


@pytest.mark.parametrize("apart", [1.9, 2.2, 2.6, 3.0])
def test_trees_side_by_side_own_their_own_wood(apart: float) -> None:
    threads, true = row_of(apart)
    assert share_owned(threads, true) > 0.99


SEEN = {
    "moved": (np.eye(3), [612.0, -40.0, 7.0]),
    "mirrored": (np.diag([-1.0, 1.0, 1.0]), [0.0, 0.0, 0.0]),
    "from behind": (np.diag([-1.0, -1.0, 1.0]), [0.0, 0.0, 0.0]),
    "turned a little": (turned(np.array([0, 0, 0.3])), [0.0, 0.0, 0.0]),
    "turned a quarter": (turned(np.array([0, 0, np.pi / 2])), [0.0, 0.0, 0.0]),
}


@pytest.mark.parametrize("way", SEEN)
def test_however_a_row_is_seen_its_wood_is_owned_alike(way: str) -> None:
    turn, shift = SEEN[way]
    threads, true = row_of(2.0)
    seen = replace(
        threads, xyz=threads.xyz @ turn.T + shift, toward_foot=threads.toward_foot @ turn.T
    )
    assert share_owned(seen, true) > 0.99


@pytest.mark.parametrize("trees", [2, 3])
def test_the_order_of_the_feet_does_not_matter(trees: int) -> None:
    graph = join_threads(row_of(1.9, trees)[0])
    feet = find_feet(graph)
    assert len(feet) == trees
    first = likeliest(graph, feet)
    for order in itertools.permutations(range(trees)):
        assert np.array_equal(likeliest(graph, feet[list(order)]), first)


def test_a_foot_is_of_its_own_tree_whatever_the_network_says(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    graph, feet = graph_and_feet(2.0)
    monkeypatch.setattr(belonging, "asked", lambda tokens, path: np.full(tokens.cost.shape, -50.0))
    given = likeliest(graph, feet)
    assert (given[feet] == feet).all()
    assert (given == belonging.NOWHERE).sum() == len(given) - 2


def test_what_nobody_was_asked_about_goes_by_cost(monkeypatch: pytest.MonkeyPatch) -> None:
    graph, feet = graph_and_feet(2.0)
    monkeypatch.setattr(belonging, "MOST_TOKENS", 3)
    given, by_cost = likeliest(graph, feet), cheapest(graph, feet)
    aside = np.abs(graph.threads.xyz[:, 0, None] - graph.threads.xyz[feet, 0]).min(axis=1)
    far = aside > 0.2
    assert far.sum() > 100 and np.array_equal(given[far], by_cost[far])


def test_the_chances_of_all_trees_and_of_none_add_up_to_one() -> None:
    logits = np.array([[2.0, -1.0, np.nan, np.nan], [1.0, -30.0, 0.5, np.nan]])
    odds = log_odds(logits)
    chance = np.nan_to_num(1 / (1 + np.exp(-odds)))
    none = 1 / (1 + np.nan_to_num(np.exp(logits)).sum(axis=0))
    assert chance.sum(axis=0) + none == pytest.approx(np.ones(4))
    assert (np.isnan(odds) == np.isnan(logits)).all()


@pytest.mark.parametrize("seed", range(6))
def test_no_other_part_of_the_ways_that_holds_the_foot_is_likelier(seed: int) -> None:
    rng = np.random.default_rng(seed)
    before = np.array([-1] + [rng.integers(row) for row in range(1, 9)])
    cost, odds = np.arange(9.0), rng.normal(0, 2, 9)
    worth = np.clip(odds, -SUREST, SUREST)

    def whole(some: tuple[int, ...]) -> bool:
        return all(before[row] in (0, *some) for row in some)

    every = itertools.chain(*(itertools.combinations(range(1, 9), k) for k in range(9)))
    best = max((some for some in every if whole(some)), key=lambda some: worth[list(some)].sum())
    kept = likely_part(cost, before, odds)
    assert np.flatnonzero(kept).tolist() == [0, *best]


def test_what_no_way_leads_to_is_no_part() -> None:
    kept = likely_part(np.array([0.0, 1.0, np.inf]), np.array([-1, 0, -1]), np.array([1.0, 1, 9]))
    assert kept.tolist() == [True, True, False]


def test_tokens_are_short_pieces_of_thread_that_hold_all_votes() -> None:
    graph, feet = graph_and_feet(2.0)
    threads = graph.threads
    tokens = Tokens.of(threads, feet, np.ones((2, len(threads))))
    assert tokens.votes.sum() == pytest.approx(threads.votes.sum())
    away = np.linalg.norm(threads.xyz - tokens.xyz[tokens.of_node], axis=1)
    assert away.max() < 2 * TOKEN_M
    assert len(tokens.xyz) < len(threads) / 4
    assert tokens.features(1, tokens.near(1, 50)).shape == (50, FEATURES)


def test_the_same_threads_have_the_same_owners_bit_for_bit() -> None:
    graph, feet = graph_and_feet(1.9)
    assert np.array_equal(likeliest(graph, feet), likeliest(graph, feet))


WRONG = {
    "no network": (lambda: b"no network", "not an ONNX file"),
    "that of points": (network.SHIPPED.read_bytes, "a network from "),
}


@pytest.mark.parametrize("kind", WRONG)
def test_a_file_that_holds_no_such_network_is_named(kind: str, tmp_path: Path) -> None:
    content, said = WRONG[kind]
    (tmp_path / "mine.onnx").write_bytes(content())
    graph, feet = graph_and_feet(2.0)
    with pytest.raises(PrunusError, match=f"mine.onnx: {said}"):
        likeliest(graph, feet, tmp_path / "mine.onnx")
