"""One trial: one tree, one draw of points, one way of doing it; what is measured of it."""

from __future__ import annotations

import time
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from prunus.evaluate.by_length import LengthEdits, edits_by_length
from prunus.evaluate.correction import corrected
from prunus.evaluate.curves import curve_measures
from prunus.evaluate.edits import Edits, edits
from prunus.evaluate.found import branch_measures
from prunus.experiment.orchard import OracleScorer, Tree
from prunus.io.tables import without_nan
from prunus.measure import shown
from prunus.model import Label, Skeleton
from prunus.paper.score import skel_score
from prunus.params import Parameters
from prunus.pipeline import follow
from prunus.result import Result

Record = dict[str, Any]
"""What is measured of a trial: plain numbers and words, as they go into results.json."""


@dataclass(frozen=True)
class Way:
    """A row of every table: its parameters, whether the edges are told, whether the base is."""

    name: str
    about: str
    params: Parameters
    oracle: bool = False
    base: bool = True


BY_HAND = "corrected by hand"
"""The way of trials that people corrected: the machine's skeleton as they found it."""

WAYS = (
    Way("paper", "the method as the paper has it, with its network", Parameters.paper()),
    Way("default", "ours", Parameters()),
    Way("default, base found", "ours, the base not given", Parameters(), base=False),
    Way(
        "paper, oracle", "the paper's, every candidate edge told truly",
        Parameters.paper(), oracle=True,
    ),
)  # fmt: skip


ABLATIONS: tuple[Way, ...] = ()


def ways(ablation: bool) -> tuple[Way, ...]:
    """The rows of every table."""
    return WAYS + ABLATIONS if ablation else WAYS


def trial(tree: Tree, draw: int, way: Way) -> Record:
    """Skeletonize one draw of a tree, correct it, measure it."""
    cloud = tree.cloud
    base = tree.truth.xyz[0] if way.base else None
    scorer = OracleScorer(tree) if way.oracle else None
    cpu = time.process_time()
    result = follow(cloud, base, way.params, draw, scorer)
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
