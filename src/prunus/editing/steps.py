"""The acts on a skeleton, one by one: what comes into which node. Rules are asked elsewhere."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from prunus.editing.acts import (
    AddPath,
    MoveBase,
    Reattach,
    Relabel,
    RemoveBranch,
    RemoveEdge,
    Step,
    Together,
)
from prunus.editing.draft import Draft
from prunus.editing.refused import Refused
from prunus.editing.routes import cheapest_way
from prunus.editing.wire import Place
from prunus.model import Floats, Label, SeededGraph

LEAST = 1e-3
"""Two nodes joined by an edge are at least so far apart, metres."""
FAR = 5.0
"""A free point lies within so many metres of the scan, else it is in another frame or unit."""


@dataclass(frozen=True, eq=False)
class Stepped:
    """A draft after an act, legal or not; `touched`: the edges whose label the person told."""

    draft: Draft
    touched: frozenset[int]


def stepped(draft: Draft, act: Step | Together, graph: SeededGraph) -> Stepped:
    """Do an act, whatever the rules say.

    Raises PrunusError where a node is not there, and Refused where no tree would be left.
    """
    if isinstance(act, Together):
        touched: frozenset[int] = frozenset()
        for one in act.acts:
            done = stepped(draft, one, graph)
            draft, touched = done.draft, touched | done.touched
        return Stepped(draft, touched & draft.into.keys())
    return STEPPED[type(act)](draft, act, graph)


def explicit(draft: Draft, act: Step | Together, graph: SeededGraph) -> Step | Together:
    """The same act with each stop of a routed path named: what it does no longer asks the graph."""
    if isinstance(act, Together):
        told: list[Step] = []
        for one in act.acts:
            clear = explicit(draft, one, graph)
            assert not isinstance(clear, Together)
            told.append(clear)
            draft = stepped(draft, clear, graph).draft
        return Together(tuple(told))
    if isinstance(act, AddPath) and act.routed:
        return replace(act, stops=_routed(draft, act, graph), routed=False)
    return act


def _routed(draft: Draft, act: AddPath, graph: SeededGraph) -> tuple[Place, ...]:
    """The stops of a path and the superpoints between them."""
    stops = list(act.stops[:1])
    for start, end in pairwise(act.stops):
        known = [n for n in (start, end) if isinstance(n, int) and n < draft.superpoints]
        if len(known) < 2:
            stops.append(end)
            continue
        taken = {*draft.nodes, *(stop for stop in stops if isinstance(stop, int))}
        way = cheapest_way(graph, known[0], known[1], taken - {known[1]})
        if way is None:
            text = f"no way over the candidate edges from node {start} to {end}: draw it straight"
            raise Refused(text, "no_way", known).at(draft)
        stops += way[1:]
    return tuple(stops)


def _add_path(draft: Draft, act: AddPath, graph: SeededGraph) -> Stepped:
    start = act.stops[0]
    if not isinstance(start, int) or start not in draft:
        text = "a path starts in the tree, and ends outside it"
        raise Refused(text, "stays_a_tree", [start] if isinstance(start, int) else []).at(draft)
    _check_new(draft, [stop for stop in act.stops[1:] if isinstance(stop, int)])
    stops = _routed(draft, act, graph) if act.routed else act.stops
    longer, nodes = _placed(draft, stops[1:], graph)
    into = {node: (above, act.label) for above, node in zip([start, *nodes], nodes, strict=False)}
    return _long_enough(Stepped(longer.changed(into), frozenset(nodes)), nodes)


def _check_new(draft: Draft, nodes: list[int]) -> None:
    """Raise where nodes are not there, in the tree already, or named twice."""
    absent = [node for node in nodes if node >= len(draft.places)]
    if absent:
        draft.require(absent[0])
    again = [node for k, node in enumerate(nodes) if node in draft or node in nodes[:k]]
    if again:
        text = f"node {again[0]} would be reached twice: a tree has no loops"
        raise Refused(text, "stays_a_tree", again).at(draft)


def _placed(draft: Draft, stops: Sequence[Place], graph: SeededGraph) -> tuple[Draft, list[int]]:
    """The draft with the free points among some stops, and the node of each stop."""
    nodes: list[int] = []
    free: list[Floats] = []
    for stop in stops:
        if isinstance(stop, int):
            nodes.append(stop)
        else:
            nodes.append(len(draft.places) + len(free))
            free.append(in_house(stop, graph))
    return draft.with_places(free), nodes


def place_of(draft: Draft, place: Place, graph: SeededGraph) -> Floats:
    """Where a node or a free point is (3,), house frame."""
    if not isinstance(place, int):
        return in_house(place, graph)
    if place >= len(draft.places):
        draft.require(place)
    return np.asarray(draft.places[place])


def in_house(point: tuple[float, float, float], graph: SeededGraph) -> Floats:
    """A free point (3,) in the house frame; Refused where it is far from all that was scanned."""
    cloud = graph.superpoints.cloud
    place = cloud.to_input.inverse().apply(point)
    beside = np.maximum(cloud.xyz.min(axis=0) - place, place - cloud.xyz.max(axis=0))
    if not (beside <= FAR).all():
        text = f"the point {point} is over {FAR:g} m from the scan; expected a place of the tree"
        raise Refused(f"{text}, in the frame of the file", "near_the_scan")
    return place


def _long_enough(done: Stepped, nodes: list[int]) -> Stepped:
    short = [node for node in nodes if done.draft.length(node) < LEAST]
    if short:
        text = "two nodes in one place cannot be joined"
        raise Refused(text, "stays_a_tree", short).at(done.draft)
    return done


def _remove_edge(draft: Draft, act: RemoveEdge, _: SeededGraph) -> Stepped:
    draft.require(act.node)
    return _removed(draft, act.node)


def _remove_branch(draft: Draft, act: RemoveBranch, _: SeededGraph) -> Stepped:
    draft.require(act.node)
    return _removed(draft, draft.branch(act.node)[0])


def _removed(draft: Draft, node: int) -> Stepped:
    if draft.into[node][0] == draft.base:
        text = "the whole tree hangs on this edge: it stays (relabel it, or move the base)"
        raise Refused(text, "keeps_its_trunk", [node]).at(draft)
    return Stepped(draft.changed(dict.fromkeys(draft.beyond(node))), frozenset())


def _relabel(draft: Draft, act: Relabel, _: SeededGraph) -> Stepped:
    draft.require(act.node)
    reached = {
        "edge": lambda node: [node],
        "branch": draft.branch,
        "onward": draft.onward,
        "until": draft.until,
    }[act.reach](act.node)
    into = {node: (draft.into[node][0], act.label) for node in reached}
    return Stepped(draft.changed(into), frozenset(reached))


def _reattach(draft: Draft, act: Reattach, _: SeededGraph) -> Stepped:
    draft.require(act.node)
    draft.require(act.onto, edge=False)
    above, label = draft.into[act.node]
    if act.onto in draft.beyond(act.node):
        text = f"node {act.onto} hangs on node {act.node} itself: a tree has no loops"
        raise Refused(text, "stays_a_tree", [act.onto]).at(draft)
    if act.onto == above:
        text = f"node {act.node} hangs on node {above} already"
        raise Refused(text, "changes_something", [act.node]).at(draft)
    into = {act.node: (act.onto, label)}
    return _long_enough(Stepped(draft.changed(into), frozenset()), [act.node])


def _move_base(draft: Draft, act: MoveBase, graph: SeededGraph) -> Stepped:
    if isinstance(act.place, int) and act.place >= len(draft.places):
        draft.require(act.place)
    draft, [node] = _placed(draft, [act.place], graph)
    if node == draft.base:
        raise Refused("the base is there already", "changes_something", [node]).at(draft)
    if node in draft:
        return Stepped(_only(draft, node, node), frozenset())
    if not draft.into:
        return Stepped(draft.changed({}, node), frozenset())
    way = _down_to(draft, node, graph)
    into = {one: (before, Label.TRUNK) for before, one in pairwise(way)}
    moved = Stepped(_only(draft, way[-1], node, into), frozenset(way[1:]))
    return _long_enough(moved, way[1:])


def _down_to(draft: Draft, node: int, graph: SeededGraph) -> list[int]:
    """From a new base up to the nearest node of the trunk that is higher."""
    height = draft.places[:, 2]
    trunk = [n for n in draft.nodes if n == draft.base or draft.into[n][1] == Label.TRUNK]
    higher = [n for n in trunk if height[n] > height[node]]
    if not higher:
        text = "no part of the trunk is higher than this place"
        raise Refused(text, "one_trunk_at_base", [node]).at(draft)
    away = np.linalg.norm(draft.places[higher] - draft.places[node], axis=1)
    joined = higher[int(away.argmin())]
    way = None
    if max(node, joined) < draft.superpoints:
        way = cheapest_way(graph, joined, node, set(draft.nodes))
    return [node, joined] if way is None else way[::-1]


def _only(
    draft: Draft, kept: int, base: int, into: dict[int, tuple[int, Label]] | None = None
) -> Draft:
    """The tree of what hangs on a node, from another base, with further edges."""
    held = set(draft.beyond(kept)[1:])
    gone = dict.fromkeys(node for node in draft.into if node not in held)
    return draft.changed({**gone, **(into or {})}, base)


STEPPED: dict[type, Callable[[Draft, Any, SeededGraph], Stepped]] = {
    AddPath: _add_path,
    RemoveEdge: _remove_edge,
    RemoveBranch: _remove_branch,
    Relabel: _relabel,
    Reattach: _reattach,
    MoveBase: _move_base,
}
"""How each act is done."""
