"""One trial: one tree, one draw of points, one way of doing it; what is measured of it."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from prunus.editing.edits import Edits, edits
from prunus.field.votes import gather_votes
from prunus.growth.graph import join_threads
from prunus.growth.parents import keep_parents
from prunus.io.tables import without_nan
from prunus.lab.evaluate.by_length import LengthEdits, edits_by_length
from prunus.lab.evaluate.correction import corrected
from prunus.lab.evaluate.curves import curve_measures
from prunus.lab.evaluate.found import branch_measures
from prunus.lab.evaluate.seen import shown
from prunus.lab.experiment.orchard import OracleScorer, Tree, TrueClasses
from prunus.method import Method
from prunus.model import Label, Skeleton
from prunus.paper.confidence import ConstantScorer
from prunus.paper.score import skel_score
from prunus.params import Parameters
from prunus.pipeline import follow
from prunus.result import Result

Record = dict[str, Any]
"""What is measured of a trial: plain numbers and words, as they go into results.json."""


Made = Callable[[Tree], Method]
"""The method of a row, for a tree: those that are told something true of it need to know it."""


@dataclass(frozen=True, kw_only=True)
class Way:
    """A row of every table: its method, whose parameters it goes by, whether the base is given."""

    name: str
    about: str
    method: Made
    params: Parameters
    base: bool = True


BY_HAND = "corrected by hand"
"""The way of trials that people corrected: the machine's skeleton as they found it."""

PAPER, DEFAULT = Parameters.paper(), Parameters()


def _paper(tree: Tree) -> Method:
    return Method.paper()


def _default(tree: Tree) -> Method:
    return Method.default()


def _told_edges(tree: Tree) -> Method:
    return Method.paper().scored_by(OracleScorer(tree))


def _told_classes(tree: Tree) -> Method:
    return _seeing(see=TrueClasses(tree))


WAYS = (
    Way(
        name="paper",
        about="the method as the paper has it, with its network",
        method=_paper,
        params=PAPER,
    ),
    Way(name="default", about="ours, the base given", method=_default, params=DEFAULT),
    Way(
        name="default, base found",
        about="ours, the base not given",
        method=_default,
        params=DEFAULT,
        base=False,
    ),
    Way(
        name="default, true classes",
        about="ours, told of all wood what it is",
        method=_told_classes,
        params=DEFAULT,
    ),
    Way(
        name="paper, oracle",
        about="the paper's, every candidate edge told truly",
        method=_told_edges,
        params=PAPER,
    ),
)


def _seeing(**parts: Any) -> Method:
    method = Method.default()
    evidence: Any = method.evidence
    return replace(method, evidence=replace(evidence, **parts))


def _growing(**parts: Any) -> Method:
    method = Method.default()
    tree: Any = method.tree
    return replace(method, tree=replace(tree, **parts))


def _with_wires(tree: Tree) -> Method:
    return _seeing(clean=lambda field, rng: field)


def _without_votes(tree: Tree) -> Method:
    return _seeing(vote=lambda field: gather_votes(replace(field, offset=0 * field.offset)))


def _without_bridges(tree: Tree) -> Method:
    return _seeing(join=lambda threads, gap_max: join_threads(threads, 0.0))


def _as_cut(tree: Tree) -> Method:
    return _growing(choose=keep_parents)


def _alike(tree: Tree) -> Method:
    return Method.paper().scored_by(ConstantScorer(SURE))


SURE = 0.9
ABLATIONS = (
    Way(
        name="default - votes",
        about="ours, voxels stay where they are",
        method=_without_votes,
        params=DEFAULT,
    ),
    Way(name="default - wires", about="ours, wires left in", method=_with_wires, params=DEFAULT),
    Way(
        name="default - bridges",
        about="ours, no gap bridged",
        method=_without_bridges,
        params=DEFAULT,
    ),
    Way(
        name="default - parents",
        about="ours, branches hang where they grew",
        method=_as_cut,
        params=DEFAULT,
    ),
    Way(
        name="paper - network",
        about="the paper's, every edge as sure as any other",
        method=_alike,
        params=PAPER,
    ),
)
"""What each part brings: a method with one part another."""


def ways(ablation: bool) -> tuple[Way, ...]:
    """The rows of every table."""
    return WAYS + ABLATIONS if ablation else WAYS


def trial(tree: Tree, draw: int, way: Way) -> Record:
    """Skeletonize one draw of a tree, correct it, measure it."""
    cloud = tree.cloud
    base = tree.truth.xyz[0] if way.base else None
    method = way.method(tree)
    cpu = time.process_time()
    result = follow(cloud, base, way.params, draw, method=method)
    cpu = time.process_time() - cpu
    return {
        "tree": tree.name,
        "draw": draw,
        "way": way.name,
        "habits": list(tree.habits),
        "points": len(result.graph.superpoints.cloud),
        "superpoints": len(result.graph.xyz),
        "candidate_edges": len(result.graph.edges),
        "tips": len(result.graph.tips),
        "cpu_s": {name: seconds for name, (seconds, _) in result.seconds.items()} | {"total": cpu},
        **judged(result, tree),
    }


def judged(result: Result, tree: Tree) -> Record:
    """The edits, the curve and branch measures, and how the corrected skeleton scores."""
    found = result.skeleton
    nodes = result.graph.superpoints.cloud.to_input.apply(result.graph.xyz)
    right = corrected(found, nodes, tree.truth, tree.counts)
    return {
        **edited(edits(found, right)),
        **_scores(found, right, result),
        **as_found(found, tree),
    }


def edited(needed: Edits) -> Record:
    """The edits of a trial."""
    counts = asdict(needed)
    for name in ("differing", "segments", "segment_edges"):
        counts[name] = {label.word: counts[name][label] for label in Label}
    return {"edit_ratio": needed.ratio, "edits": counts}


def as_found(found: Skeleton, tree: Tree) -> Record:
    """The edits by length, the curve and the branch measures of a trial."""
    return {
        "by_length": by_length(edits_by_length(found, tree.truth, tree.counts)),
        "curves": without_nan(curve_measures(found, tree.truth)),
        "branches": without_nan(branch_measures(found, tree.truth)),
        "branches_shown": without_nan(branch_measures(found, shown(tree.truth, tree.counts))),
    }


def by_length(needed: LengthEdits) -> Record:
    """The edits by length of a trial, metres."""
    names = ("wrong", "unasked", "missing", "mislabelled", "length")
    metres = {name: getattr(needed, name) for name in names}
    return without_nan({"ratio": needed.ratio, "geometry_ratio": needed.geometry_ratio, **metres})


def _scores(found: Skeleton, right: Skeleton, result: Result) -> Record:
    """What a skeleton and the corrected one score, where the method goes by a score."""
    if result.score is None:
        return {}
    return {"score": score_of(found, result), "score_of_corrected": score_of(right, result)}


def score_of(skeleton: Skeleton, result: Result) -> float:
    """SkelScore of a skeleton on the superpoints of a result.

    Edges that are no candidates have no confidence.
    """
    graph = result.graph
    known = dict(zip(map(tuple, graph.edges.tolist()), graph.confidence.tolist(), strict=True))
    ends = np.sort(skeleton.superpoint[skeleton.edges], axis=1).tolist()
    confidence = [float("nan"), *(known.get((i, j), 0.0) for i, j in ends)]
    return skel_score(replace(skeleton, confidence=np.array(confidence)), result.params)
