"""Figures of the whole experiment, by way, from what was measured of each trial."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from prunus.editing.edits import Edits, label_ratios
from prunus.lab.experiment.habits import HABITS
from prunus.lab.experiment.trial import Record
from prunus.model import Label

BEFORE = ("sample", "superpoints", "candidates", "confidence", "seeds", "field", "votes")
"""Stages before the search."""


def summary(trials: list[Record]) -> dict[str, Record]:
    """Of each way: edit ratios, branches found, cost, scores; medians over trials, see `way_of`."""
    names = list(dict.fromkeys(trial["way"] for trial in trials))
    return {name: way_of([t for t in trials if t["way"] == name]) for name in names}


def way_of(trials: list[Record]) -> Record:
    """The figures of one way. A trial without a skeleton counts with an edit ratio of 1."""
    done = [trial for trial in trials if "error" not in trial]
    ratios = edit_ratios(trials)
    timed = [trial for trial in done if "cpu_s" in trial]
    scored = [trial for trial in done if "score_of_corrected" in trial]
    return {
        "trials": len(trials),
        "failed": len(trials) - len(done),
        "edit_ratio": spread(ratios),
        "by_length": spread(_by_length(trials, "ratio")),
        "geometry_by_length": spread(_by_length(trials, "geometry_ratio")),
        "labels": {label.word: spread(values) for label, values in by_label(done).items()},
        "leaders_found": _share(done, "branches", "leaders_found", "leaders_true"),
        "leaders_found_of_shown": _share(done, "branches_shown", "leaders_found", "leaders_true"),
        "false_leaders": _mean(done, "branches", "false_leaders"),
        "side_branches_found_of_shown": _share(
            done, "branches_shown", "side_branches_found", "side_branches_true"
        ),
        "false_side_branches": _mean(done, "branches", "false_side_branches"),
        "parents_right": _parents(done),
        "supports_right": _share(done, "branches", "supports_right", "supports_true"),
        "base_error": spread([trial["branches"]["base_error"] for trial in done]),
        "curves": {
            f"{word}_{kind}": _mean(done, "curves", f"{word}_{kind}")
            for word in (*(label.word for label in Label), "geometry")
            for kind in ("recall", "precision", "f1")
        },
        "cpu_s": spread([trial["cpu_s"]["total"] for trial in timed]),
        "cpu_before_search": _median(before(trial) / all_stages(trial) for trial in timed),
        "score_found": _median(trial["score"] for trial in scored),
        "score_of_corrected": _median(trial["score_of_corrected"] for trial in scored),
        "corrected_scores_less": float(
            np.mean([t["score_of_corrected"] < t["score"] for t in scored]) if scored else math.nan
        ),
        "habits": _by_habit(trials, edit_ratios),
    }


def edit_ratios(trials: list[Record]) -> list[float]:
    """The global edit ratio of each trial."""
    return [trial.get("edit_ratio", 1.0) for trial in trials]


def _by_length(trials: list[Record], name: str) -> list[float]:
    """A ratio by length of each trial; without a skeleton all is missing."""
    return [trial["by_length"][name] if "by_length" in trial else 1.0 for trial in trials]


def by_label(trials: list[Record]) -> dict[Label, list[float]]:
    """The edit ratios of each label, one a trial; NaN where the corrected tree has none of it."""
    return label_ratios([_edits(trial["edits"]) for trial in trials])


def _edits(record: Record) -> Edits:
    names = ("differing", "segments", "segment_edges")
    by_word = {n: {label: record[n][label.word] for label in Label} for n in names}
    return Edits(**(record | by_word))


def spread(values: Iterable[float]) -> Record:
    """Median, quartiles, least, most and number of those values that are numbers."""
    known = [value for value in values if value is not None and not math.isnan(value)]
    if not known:
        return {"median": None, "quartiles": None, "least": None, "most": None, "number": 0}
    quartiles = np.quantile(known, [0.25, 0.75]).tolist()
    return {"median": float(np.median(known)), "quartiles": quartiles, "least": min(known),
            "most": max(known), "number": len(known)}  # fmt: skip


def before(trial: Record) -> float:
    """CPU seconds before the search, or before the tree grows."""
    return float(sum(trial["cpu_s"].get(stage, 0.0) for stage in BEFORE))


def all_stages(trial: Record) -> float:
    """CPU seconds of all stages."""
    return float(sum(seconds for stage, seconds in trial["cpu_s"].items() if stage != "total"))


def _by_habit(trials: list[Record], ratios: Callable[[list[Record]], list[float]]) -> Record:
    """Trees with each habit, and the median edit ratio of their trials."""
    found = {}
    for habit in HABITS:
        own = [trial for trial in trials if habit in trial["habits"]]
        trees = len({trial["tree"] for trial in own})
        found[habit] = {"trees": trees, "edit_ratio": _median(ratios(own))}
    return found


def _share(trials: list[Record], group: str, part: str, whole: str) -> float | None:
    total = sum(trial[group][whole] for trial in trials)
    return sum(trial[group][part] for trial in trials) / total if total else None


def _parents(trials: list[Record]) -> float | None:
    """Share of the found branches that hang on the right one."""
    names = ("leaders", "side_branches")
    found = sum(trial["branches"][f"{name}_found"] for trial in trials for name in names)
    right = sum(trial["branches"][f"{name}_parents_right"] for trial in trials for name in names)
    return right / found if found else None


def _mean(trials: list[Record], group: str, name: str) -> float | None:
    known: list[Any] = [trial[group][name] for trial in trials if trial[group][name] is not None]
    return float(np.mean(known)) if known else None


def _median(values: Iterable[float]) -> float | None:
    known = list(values)
    return float(np.median(known)) if known else None
