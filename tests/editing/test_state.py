"""Base and points picked for the next run of the chain."""

from functools import cache

import numpy as np
import pytest

from prunus.editing import (
    Brush,
    Class,
    Mark,
    MoveBase,
    PickBase,
    Rebuild,
    Refused,
    RemoveEdge,
)
from prunus.editing.state import State, apply
from prunus.growth.chain import Votes
from prunus.model import Kind
from prunus.pipeline import skeletonize
from tests.conftest import field_scan
from tests.editing.trees import node, outside, state


@cache
def raw() -> State:
    """What the machine finds in a raw scan with other trees."""
    cloud = field_scan(2).cloud().sample(50_000, np.random.default_rng(0))
    return State.of(skeletonize(cloud))


def test_a_base_that_was_picked_waits_for_the_next_run() -> None:
    at = state()
    after = apply(at, PickBase(node(at, 3, 1)))
    assert after.draft is at.draft
    assert after.base == pytest.approx(at.draft.places[node(at, 3, 1)])
    with pytest.raises(Refused, match="over 5 m from the scan"):
        apply(at, PickBase((0.0, 0.0, 0.0)))


def test_isolation_says_what_each_point_is_before_anyone_does() -> None:
    at = raw()
    assert at.result.isolated is not None
    assert np.array_equal(at.kind, at.result.isolated.kind)
    assert not at.marked


def test_the_base_of_another_tree_gives_that_tree() -> None:
    at = raw()
    view = Votes().look(at.scan, None, at.params, np.random.default_rng(0), {})
    trees = [one.points_of_tree() for one in view.each()]
    others = [t for t in trees if np.linalg.norm(t.foot - at.draft.places[at.draft.base]) > 0.5]
    base = max(others, key=lambda tree: tree.target.sum()).foot
    after = apply(apply(at, PickBase(outside(at, base))), Rebuild())
    there = after.draft.places[after.draft.base]
    assert np.linalg.norm(there - base) < 0.3
    assert (after.kind != at.kind).any()
    assert not after.marked


def test_what_was_marked_is_what_the_next_run_sees() -> None:
    at = apply(raw(), Mark(Class(Kind.STRAY), Kind.POST))
    after = apply(at, Rebuild())
    assert np.array_equal(after.kind, at.kind)
    assert len(after.result.scan) == (at.kind == Kind.TARGET).sum()
    assert after.result.isolated is None
    assert after.result.params.isolation.isolate == "never"
    assert after.params == at.params


def test_taking_points_away_elsewhere_leaves_the_base_where_it_stands() -> None:
    at = raw()
    stands = at.draft.places[at.draft.base]
    xyz = at.scan.xyz
    top = outside(at, [*xyz[np.argmax(np.where(at.kind == Kind.TARGET, xyz[:, 2], -9.0))]])
    after = apply(apply(at, Mark(Brush((tuple(top),), 0.3), Kind.STRAY)), Rebuild())
    assert np.linalg.norm(after.draft.places[after.draft.base] - stands) < 0.1


def test_a_run_forgets_the_corrections_before_it_but_not_the_base(machine: State) -> None:
    up = machine.draft.after[machine.draft.after[machine.draft.base][0]][0]
    at = apply(apply(machine, RemoveEdge(machine.draft.nodes[-1])), MoveBase(up))
    after = apply(at, Rebuild())
    assert at.held.removed
    assert not after.held.removed
    assert not after.held.label
    assert after.draft.places[after.draft.base] == pytest.approx(at.draft.places[up], abs=0.1)
    assert after.draft.nodes == [int(n) for n in after.result.in_house.superpoint]


def test_points_too_far_from_the_base_are_no_tree(machine: State) -> None:
    low, high = machine.scan.xyz.min(axis=0), machine.scan.xyz.max(axis=0)
    at = apply(machine, PickBase(outside(machine, [low[0] - 2, *high[1:]])))
    with pytest.raises(Refused, match="of the points left: the base"):
        apply(at, Rebuild())
