"""The pruning plan of a tree as it is corrected so far."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from prunus.cuts import Plan, plan_cuts
from prunus.cuts.plan_file import plan_file
from prunus.editing import State
from prunus.editing.draft import Pair, pair_of
from prunus.errors import PrunusError
from prunus.files.work_folder import CORRECTED, SKELETON
from prunus.io.skeletons.plans import PlanFile, made_on, read_plan, write_plan
from prunus.io.skeletons.skeleton_file import sha256_of
from prunus.model import Floats, Kind, Skeleton
from prunus.model.branches import branches
from prunus.refine.refined import refined
from prunus.result import REFINED_WITH
from prunus.session import Work


@dataclass(frozen=True, eq=False)
class Planned:
    """A plan, the refined skeleton that it was made on, and a node of each branch by its name."""

    plan: Plan
    skeleton: Skeleton
    node: dict[str, int]


def planned(state: State) -> Planned:
    """The plan by the shipped rules, house frame; takes some tenths of a second.

    The tree is refined to the points that are marked as its own; PrunusError where there are none.
    Branches have the names that they have on the page: refining keeps their order.
    """
    own = state.scan.take(state.kind == Kind.TARGET)
    if len(own) == 0:
        raise PrunusError("no point is marked as the tree's: there is nothing to plan by")
    points = own.sample(REFINED_WITH, np.random.default_rng(state.result.seed))
    coarse = state.draft.numbered()
    tree = refined(coarse, points, _vouched(state, coarse))
    plan = plan_cuts(tree, state.scan.xyz)
    return Planned(plan, tree.skeleton, _nodes(coarse, tree.names))


def _vouched(state: State, tree: Skeleton) -> Floats:
    """How likely the branch of each row (M,) of the corrected tree is right.

    What a person told is sure; of the rest, what the machine's tree had there.
    """
    trust, machine = state.result.trust, state.result.in_house
    likely = np.full(len(machine), np.nan) if trust is None else trust.of_rows(machine)
    had = dict(zip(_pairs(machine), likely.tolist(), strict=True))
    return np.array(
        [1.0 if pair in state.held.label else had.get(pair, np.nan) for pair in _pairs(tree)]
    )


def _pairs(tree: Skeleton) -> list[Pair]:
    """The nodes of the edge into each row."""
    nodes = tree.superpoint.tolist()
    return [pair_of(nodes[above], node) for above, node in zip(tree.parent, nodes, strict=True)]


def _nodes(tree: Skeleton, names: list[str]) -> dict[str, int]:
    """The first node of each branch, by its name."""
    firsts = (int(tree.superpoint[branch.rows[1]]) for branch in branches(tree))
    return dict(zip(names, firsts, strict=True))


def file_of(plan: Plan, work: Work) -> PlanFile:
    """The plan of the work as it stands, as `plan.json` has it."""
    state, scan = work.state, work.scan
    tree = state.result.skeleton
    if work.position:
        tree = state.draft.skeleton().moved(state.scan.to_input)
    return plan_file(
        plan,
        scan.cloud.to_input,
        skeleton=CORRECTED if work.position else SKELETON,
        skeleton_sha256=sha256_of(tree),
        input=scan.record,
        notes=scan.notes,
    )


def save(path: Path, file: PlanFile) -> None:
    """Write a plan; PrunusError where that of another scan would be lost, or it cannot be done."""
    try:
        other = _of_another_scan(read_plan(path), file) if path.exists() else ""
    except PrunusError:  # no plan, so nothing is lost
        other = ""
    if other:
        raise PrunusError(f"{path}: {other}; move it away to save this one")
    write_plan(path, file)


def told_of_file(path: Path, file: PlanFile) -> str:
    """Whether a plan is in a file, in words."""
    if not path.exists():
        return "not saved"
    try:
        there = read_plan(path)
    except PrunusError as error:
        return f"cannot be read: {error}"
    if there == file:
        return f"saved in {path.name}"
    other = _of_another_scan(there, file) or "is of the tree as it was before"
    return f"{path.name} {other}"


def _of_another_scan(there: PlanFile, file: PlanFile) -> str:
    """Of what other scan a plan is, in words; nothing where it is of the same."""
    if there.input is None or file.input is None or there.input.sha256 == file.input.sha256:
        return ""
    return f"is the plan of another tree, {made_on(there)}; this is {made_on(file)}"
