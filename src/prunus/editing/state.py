"""One tree under correction, and what an act makes of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from prunus.editing.acts import (
    Act,
    Mark,
    PickBase,
    Rebuild,
    Search,
    SetStatus,
    Step,
    Together,
)
from prunus.editing.apply import corrected
from prunus.editing.draft import Draft
from prunus.editing.hold import NOTHING, Held, searched
from prunus.editing.marks import Kinds, chosen
from prunus.editing.refused import Refused
from prunus.editing.steps import explicit, place_of
from prunus.errors import PrunusError
from prunus.model import Floats, Kind, PointCloud
from prunus.params import Parameters
from prunus.pipeline import skeletonize
from prunus.result import Result

Chain = Callable[[PointCloud, Floats | None, Parameters, int], Result]
"""What `Rebuild` runs: on these points, from this base, by these parameters and this seed."""


@dataclass(frozen=True, eq=False, kw_only=True)
class State:
    """A tree after some acts. The values before it stay as they were.

    `scan` holds all points; `params` is how the machine is run; `result` what it made of the points
    that are the tree; `kind` (P,) what each point is, by isolation or by hand (`marked`); `base`
    (3,), house frame, where a person put it; `held` what a new search keeps.
    """

    scan: PointCloud
    params: Parameters
    result: Result
    kind: Kinds
    draft: Draft
    marked: bool = False
    base: Floats | None = None
    held: Held = NOTHING
    done: bool = False

    @classmethod
    def of(cls, result: Result) -> State:
        """What the machine found, before any act."""
        return cls(
            scan=result.scan,
            params=result.params,
            result=result,
            kind=_kinds(result),
            draft=Draft.of(result),
        )


def _kinds(result: Result) -> Kinds:
    """What each point of a scan is, as isolation has it: all the tree, where nothing was asked."""
    none = np.full(len(result.scan), Kind.TARGET, np.int8)
    kind = none if result.isolated is None else result.isolated.kind.astype(np.int8)
    kind.setflags(write=False)
    return kind


def apply(state: State, act: Act, chain: Chain = skeletonize) -> State:
    """The state after an act; `chain` is run to build the tree again.

    Raises Refused, with what could be done instead, where the act would leave no legal tree, and
    PrunusError where it names what is not there.
    """
    if isinstance(act, SetStatus):
        return replace(state, done=act.done)
    if isinstance(act, PickBase):
        return replace(state, base=place_of(state.draft, act.place, state.result.graph))
    if isinstance(act, Mark):
        return _marked(state, act)
    if isinstance(act, Rebuild):
        return _rebuilt(state, chain)
    if isinstance(act, Search):
        params, seed = state.result.params, state.result.seed
        draft = searched(state.draft, state.held, state.result.graph, params, seed)
        return replace(state, draft=draft)
    return _corrected(state, act)


def clear(state: State, act: Act) -> Act:
    """The same act, with nothing left to the graph: a routed path names its superpoints."""
    if isinstance(act, PickBase | Mark | Rebuild | Search | SetStatus):
        return act
    return explicit(state.draft, act, state.result.graph)


def _corrected(state: State, act: Step | Together) -> State:
    done = corrected(state.draft, act, state.result.graph)
    held = state.held.after(state.draft, done.draft, done.touched)
    moved = done.draft.base != state.draft.base
    base = done.draft.places[done.draft.base] if moved else state.base
    return replace(state, draft=done.draft, held=held, base=base)


def _marked(state: State, act: Mark) -> State:
    new = chosen(act.where, state.scan, state.kind) & (state.kind != act.kind)
    if not new.any():
        text = f"no point was chosen that is not {act.kind.name.lower()} already"
        raise Refused(text, "changes_something")
    kind = np.where(new, np.int8(act.kind), state.kind)
    kind.setflags(write=False)
    return replace(state, kind=kind, marked=True)


def _rebuilt(state: State, chain: Chain) -> State:
    """The chain on the points that are the target."""
    target = state.kind == Kind.TARGET
    if not target.any():
        raise Refused("no point is marked as the target", "holds_the_tree")
    cloud, params = state.scan, state.params
    if state.marked:
        cloud, params = cloud.take(target), params.changed("isolation", isolate="never")
    base = _base_of_next(state, cloud)
    try:
        result = chain(cloud, base, params, state.result.seed)
    except PrunusError as error:
        raise Refused(f"of the points left: {error}", "holds_the_tree") from error
    kind = state.kind if state.marked else _kinds(result)
    return replace(state, result=result, kind=kind, draft=Draft.of(result), held=NOTHING)


def _base_of_next(state: State, cloud: PointCloud) -> Floats | None:
    """Where the next run begins, in the frame of the file; None where it shall look itself.

    That is the base that was picked, or, once points were marked, the one that stands, as long as
    points are left around it: with fewer points the chain might find another.
    """
    base = state.base
    if base is None and state.marked:
        stands = state.draft.places[state.draft.base]
        if np.linalg.norm(cloud.xyz - stands, axis=1).min() < AROUND:
            base = stands
    return None if base is None else state.scan.to_input.apply(base)


AROUND = 0.20
"""Points are left around a base where one is so near, metres."""
