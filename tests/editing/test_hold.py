"""A new search keeps what was corrected, whatever it thinks of it."""

from pathlib import Path

import numpy as np
import pytest

from prunus.editing import AddPath, MoveBase, Refused, Relabel, RemoveEdge, Search
from prunus.editing.draft import pair_of
from prunus.editing.hold import held_graph
from prunus.editing.relabel import relabelled
from prunus.editing.state import State, apply
from prunus.errors import PrunusError
from prunus.frames.scan import open_scan
from prunus.model import Label
from prunus.params import Parameters
from prunus.pipeline import skeletonize
from prunus.rules import offenders
from tests.editing.trees import node, outside, random_act, spare, state


def holds(after: State, at: State) -> bool:
    """Whether all that was corrected is in a tree, with its labels, and nothing removed is."""
    now = {pair_of(above, n): label for n, (above, label) in after.draft.into.items()}
    kept = all(now.get(pair) == label for pair, label in at.held.label.items())
    return kept and not at.held.removed & now.keys()


@pytest.fixture(scope="module")
def searching(scan_file: Path) -> State:
    """What a machine finds that searches."""
    paper = Parameters.paper().changed("search", K=20)
    return State.of(skeletonize(open_scan(scan_file, "z-up").cloud, params=paper))


@pytest.mark.parametrize("which", ["machine", "searching"])
@pytest.mark.parametrize("seed", range(15))
def test_what_was_corrected_is_there_after_the_search(
    seed: int, which: str, request: pytest.FixtureRequest
) -> None:
    at, rng = request.getfixturevalue(which), np.random.default_rng(seed)
    for _ in range(8):
        try:
            at = apply(at, random_act(at, rng))
        except Refused as refused:
            at = apply(at, refused.repairs[0][1]) if refused.repairs else at
        except PrunusError:
            continue
    after = apply(at, Search())
    assert holds(after, at)
    broken = set(offenders(after.draft.skeleton()))
    assert not broken & {"label_progression", "one_trunk_at_base"}
    assert which == "machine" or not broken
    assert after.draft.base == at.draft.base
    assert holds(apply(after, Search()), at), "a second search keeps it too"


@pytest.mark.parametrize("which", ["machine", "searching"])
def test_without_corrections_the_search_finds_what_it_found(
    which: str, request: pytest.FixtureRequest
) -> None:
    at = request.getfixturevalue(which)
    assert apply(at, Search()).draft.into == at.draft.into


@pytest.mark.parametrize("label", list(Label))
def test_labels_around_one_that_was_told_follow_the_grammar(label: Label) -> None:
    at = state()
    tip = node(at, 0, 5)
    told = {pair_of(at.draft.into[tip][0], tip): label}
    after = relabelled(at.draft, told, at.result.graph)
    assert after.into[tip] == (at.draft.into[tip][0], label)
    assert {n: above for n, (above, _) in after.into.items()} == {
        n: above for n, (above, _) in at.draft.into.items()
    }
    broken = offenders(after.skeleton())
    assert not {"label_progression", "one_trunk_at_base"} & set(broken)
    assert relabelled(after, told, at.result.graph).into == after.into


def test_the_search_does_not_take_back_what_was_removed() -> None:
    at = state()
    edge = node(at, 4, 3)
    at = apply(at, RemoveEdge(edge))
    after = apply(at, Search())
    assert at.held.removed
    assert holds(after, at)


def test_an_unlikely_path_stays_where_a_person_drew_it(machine: State) -> None:
    """Into the air, over free points: no confidence speaks for it."""
    draft = machine.draft
    leader = next(n for n in draft.nodes if n in draft.into and draft.into[n][1] == Label.LEADER)
    away = [outside(machine, draft.places[leader] + [0.0, 0.3 * k, 0.0]) for k in (1, 2)]
    at = apply(machine, AddPath((leader, *away), Label.SIDE_BRANCH))
    after = apply(at, Search())
    count = len(draft.places)
    assert after.draft.into[count] == (leader, Label.SIDE_BRANCH)
    assert after.draft.into[count + 1] == (count, Label.SIDE_BRANCH)


def test_a_label_that_was_confirmed_stays(machine: State) -> None:
    top = machine.draft.nodes[-1]
    label = machine.draft.into[top][1]
    at = apply(machine, Relabel(top, label, "branch"))
    assert at.draft.into == machine.draft.into
    assert len(at.held.label) == len(machine.draft.branch(top))


def test_held_edges_are_sure_in_the_graph_and_removed_ones_are_not_in_it() -> None:
    at = state()
    top = node(at, 0, 5)
    at = apply(at, AddPath((top, spare(at, node(at, 7, 5))), Label.LEADER))
    at = apply(at, RemoveEdge(node(at, 5, 4)))
    graph = held_graph(at.draft, at.held, at.result.graph)
    edges = [tuple(pair) for pair in graph.edges.tolist()]
    added = edges.index(pair_of(top, spare(at, node(at, 7, 5))))
    assert graph.confidence[added] == 1
    assert graph.scored.category[added].tolist() == [0, 0, 1, 0, 0]
    assert pair_of(node(at, 5, 4), node(at, 4, 4)) not in edges
    assert edges == sorted(edges)


def test_the_search_starts_at_the_base_that_was_moved() -> None:
    at = state()
    up = node(at, 3, 1)
    after = apply(apply(at, MoveBase(up)), Search())
    assert after.draft.base == up
    assert at.draft.base not in after.draft
