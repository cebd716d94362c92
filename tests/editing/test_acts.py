"""Acts as JSON: what was written comes back, and nothing else comes in."""

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as some

from prunus.editing import (
    Act,
    AddPath,
    Box,
    Brush,
    Class,
    Component,
    Lasso,
    Mark,
    MoveBase,
    PickBase,
    Reattach,
    Rebuild,
    Relabel,
    RemoveBranch,
    RemoveEdge,
    Search,
    SetStatus,
    Slab,
    Together,
    from_json,
    to_json,
)
from prunus.errors import PrunusError
from prunus.model import Kind, Label

NODES = some.integers(0, 10_000)
NUMBERS = some.floats(-1e7, 1e7)
POINTS = some.tuples(NUMBERS, NUMBERS, NUMBERS)
PLACES = NODES | POINTS
LABELS, KINDS = some.sampled_from(Label), some.sampled_from(Kind)
LENGTHS = some.floats(1e-3, 10)
ROWS = some.tuples(NUMBERS, NUMBERS, NUMBERS, NUMBERS)


def several(what: some.SearchStrategy, least: int) -> some.SearchStrategy:
    return some.lists(what, min_size=least, max_size=4).map(tuple)


STEPS = some.one_of(
    some.builds(AddPath, several(PLACES, 2), LABELS, some.booleans()),
    some.builds(RemoveEdge, NODES),
    some.builds(RemoveBranch, NODES),
    some.builds(Relabel, NODES, LABELS, some.sampled_from(["edge", "branch", "onward", "until"])),
    some.builds(Reattach, NODES, NODES),
    some.builds(MoveBase, PLACES),
)
SHAPES = some.one_of(
    some.builds(Box, POINTS, POINTS),
    some.builds(
        Lasso,
        several(some.tuples(NUMBERS, NUMBERS), 3),
        some.tuples(ROWS, ROWS, ROWS, ROWS),
        some.none() | some.builds(Slab, POINTS, NUMBERS, NUMBERS),
    ),
    some.builds(Brush, several(POINTS, 1), LENGTHS),
    some.builds(Component, POINTS, LENGTHS),
    some.builds(Class, KINDS),
)
ACTS = some.one_of(
    STEPS,
    some.builds(Together, several(STEPS, 1)),
    some.builds(Mark, SHAPES, KINDS),
    some.builds(PickBase, PLACES),
    some.builds(Rebuild),
    some.builds(Search),
    some.builds(SetStatus, some.booleans()),
)


@given(ACTS)
def test_what_was_written_comes_back(act: Act) -> None:
    assert from_json(json.loads(json.dumps(to_json(act)))) == act


def test_names_in_files_are_in_snake_case() -> None:
    assert to_json(AddPath((3, (1.0, 2.0, 3.5)), Label.SIDE_BRANCH)) == {
        "act": "add_path",
        "stops": [3, [1.0, 2.0, 3.5]],
        "label": "side_branch",
        "routed": False,
    }
    shape = to_json(Mark(Class(Kind.GROUND), Kind.TARGET))["where"]
    assert shape == {"shape": "class", "kind": "ground"}


@pytest.mark.parametrize(
    ("told", "says"),
    [
        ([], "expected an object with 'act'"),
        ({"node": 3}, "unknown act None"),
        ({"act": "fly"}, "unknown act 'fly'; expected one of add_path"),
        ({"act": ["remove_edge"]}, "unknown act"),
        ({"act": "remove_edge"}, "remove_edge.node: missing"),
        ({"act": "remove_edge", "node": -1}, "greater than or equal to 0; found -1"),
        ({"act": "remove_edge", "node": True}, "valid integer; found True"),
        ({"act": "remove_edge", "node": 1.0}, "valid integer; found 1.0"),
        ({"act": "remove_edge", "node": "1"}, "valid integer; found '1'"),
        ({"act": "remove_edge", "node": 1, "more": 2}, "remove_edge.more: unexpected"),
        ({"act": "add_path", "stops": [1], "label": "leader"}, "at least 2 items"),
        ({"act": "add_path", "stops": [1, [1, 2]], "label": "leader"}, "add_path.stops.1: found"),
        ({"act": "add_path", "stops": [1, [1, 2, np.nan]], "label": "leader"}, "expected a node"),
        ({"act": "add_path", "stops": [1, 2], "label": "twig"}, "unknown label 'twig'"),
        ({"act": "add_path", "stops": [1, 2], "label": [2]}, "add_path.label: found [2]"),
        ({"act": "relabel", "node": 1, "label": "leader", "reach": "far"}, "'edge', 'branch'"),
        ({"act": "mark", "where": {"shape": "ball"}, "kind": "post"}, "unknown shape 'ball'"),
        ({"act": "mark", "where": {"shape": "class", "kind": {}}, "kind": "post"}, "class.kind"),
        (
            {"act": "mark", "where": {"shape": "brush", "centres": [[0, 0, 0]], "radius": 0}},
            "brush.radius: input should be greater than 0",
        ),
        ({"act": "together", "acts": [{"act": "search"}]}, "together.acts.0: unknown act"),
        ({"act": "together", "acts": []}, "at least 1 item"),
        ({"act": "set_status", "done": 1}, "valid boolean; found 1"),
    ],
)
def test_what_is_no_act_is_told_by_field(told: object, says: str) -> None:
    with pytest.raises(PrunusError, match=r".") as raised:
        from_json(told)
    assert says in str(raised.value)
