"""What is measured of a skeleton on one case, and what is told of all cases of a set."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from scipy.spatial import cKDTree

from bench.set_cases import Case
from bench.set_methods import Found
from prunus.lab.evaluate.along import pieces_of
from prunus.lab.evaluate.by_length import edits_by_length, geometry_f1
from prunus.lab.evaluate.curves import SPACING
from prunus.lab.evaluate.found import branch_measures
from prunus.lab.evaluate.seen import shown
from prunus.model import Skeleton

ALONG_WIRE_M, ON_WOOD_M = 0.03, 0.06
"""A piece follows a wire that lies so near to one, and not so near to true wood."""
RESAMPLES = 2000
Figures = dict[str, float]
"""Of one case; NaN: not asked, or not known."""


def figures_of(case: Case, found: Found | None) -> Figures:
    """All figures of what a method made of a case; nothing made counts as an empty skeleton."""
    none = case.truth.part(np.arange(len(case.truth)) == 0)
    tree = none if found is None else found.skeleton
    figures = {"failed": float(found is None)} | _by_length(case, tree)
    if case.has_roles:
        figures |= _branches(case, tree)
    away = float(np.linalg.norm(tree.xyz[0] - case.truth.xyz[0]))
    figures["base"] = math.nan if found is None else away
    if found is not None and found.kept is not None:
        figures["kept"] = float(found.kept[case.target].mean())
        if not case.target.all():
            figures["out"] = float((~found.kept[~case.target]).mean())
    if len(case.wires):
        figures["wire"] = _along_wires(case, tree)
    return figures


def _by_length(case: Case, tree: Skeleton) -> Figures:
    needed = edits_by_length(tree, case.truth, case.counts)
    figures = {
        "geometry": needed.geometry_ratio,
        "f1 2": geometry_f1(tree, case.truth, case.counts, 0.02),
        "f1 5": geometry_f1(tree, case.truth, case.counts, 0.05),
        "unasked": needed.unasked / needed.length,
    }
    if case.has_roles:
        figures |= {"ratio": needed.ratio, "labels": needed.label_accuracy}
    return figures


def _branches(case: Case, tree: Skeleton) -> Figures:
    """Found ones are of those that the scan shows; false ones are near no true one at all."""
    seen = branch_measures(tree, shown(case.truth, case.counts))
    every = branch_measures(tree, case.truth)
    counted = {
        f"{name}_{kind}": seen[f"{name}_{kind}"]
        for name in ("leaders", "side_branches")
        for kind in ("true", "found", "parents_right")
    }
    return counted | {name: every[name] for name in ("false_leaders", "false_side_branches")}


def _along_wires(case: Case, tree: Skeleton) -> float:
    """Metres of a skeleton that follow a wire."""
    ours, wood = pieces_of(tree).xyz, pieces_of(case.truth).xyz
    if len(ours) == 0:
        return 0.0
    wired = cKDTree(case.wires).query(ours)[0] < ALONG_WIRE_M
    return SPACING * float((wired & (cKDTree(wood).query(ours)[0] > ON_WOOD_M)).sum())


def lines_of(records: Sequence[Figures]) -> dict[str, str]:
    """What is printed of all cases of a set, by what it is."""
    return {
        "A2, median [95 %] / worst": _median(records, "ratio"),
        "geometry ratio, median [95 %] / worst": _median(records, "geometry"),
        "   of either on true wood not asked for": _mean(records, "unasked"),
        "F1 at 2 cm, mean / worst": _mean(records, "f1 2", min),
        "F1 at 5 cm, mean / worst": _mean(records, "f1 5", min),
        "leaders found": _of(records, ["leaders_found"], ["leaders_true"]),
        "side branches found": _of(records, ["side_branches_found"], ["side_branches_true"]),
        "false leaders a tree": _mean(records, "false_leaders"),
        "false side branches a tree": _mean(records, "false_side_branches"),
        "label accuracy, mean / worst": _mean(records, "labels", min),
        "right parent, of the found": _of(
            records,
            ["leaders_parents_right", "side_branches_parents_right"],
            ["leaders_found", "side_branches_found"],
        ),
        "base error, cm, median / worst": _base(records),
        "tree kept by isolation, mean / worst": _mean(records, "kept", min),
        "all else taken out, mean / worst": _mean(records, "out", min),
        "m of wire a tree": _mean(records, "wire"),
        "failed": f"{sum(r['failed'] for r in records):.0f} of {len(records)}",
        "CPU s, median / worst": _cpu(records),
    }


def known(records: Sequence[Figures], name: str) -> list[float]:
    """That figure of the cases that have it."""
    return [r[name] for r in records if not math.isnan(r.get(name, math.nan))]


def interval(values: Sequence[float]) -> tuple[float, float]:
    """The middle 95 % of the medians of trees drawn again."""
    drawn = np.random.default_rng(0).choice(values, (RESAMPLES, len(values)))
    low, high = np.quantile(np.median(drawn, axis=1), [0.025, 0.975])
    return float(low), float(high)


def _median(records: Sequence[Figures], name: str) -> str:
    values = known(records, name)
    if not values:
        return "-"
    low, high = interval(values)
    return f"{np.median(values):.3f} [{low:.3f}, {high:.3f}] / {max(values):.3f}"


def _mean(
    records: Sequence[Figures], name: str, worst: Callable[[list[float]], float] | None = None
) -> str:
    values = known(records, name)
    if not values:
        return "-"
    rest = "" if worst is None else f" / {worst(values):.3f}"
    return f"{np.mean(values):.3f}{rest}"


def _of(records: Sequence[Figures], part: list[str], whole: list[str]) -> str:
    parts, wholes = (sum(sum(known(records, n)) for n in names) for names in (part, whole))
    return f"{parts / wholes:.3f} ({parts:.0f} of {wholes:.0f})" if wholes else "-"


def _base(records: Sequence[Figures]) -> str:
    away = [100 * value for value in known(records, "base")]
    return f"{np.median(away):.1f} / {max(away):.1f}" if away else "-"


def _cpu(records: Sequence[Figures]) -> str:
    spent = known(records, "cpu")
    return f"{np.median(spent):.2f} / {max(spent):.2f}"
