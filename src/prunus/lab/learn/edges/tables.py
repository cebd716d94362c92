"""The paper's two tables for a network of ours, and how well its confidence is calibrated."""

from __future__ import annotations

from typing import Any

import numpy as np

from prunus.io.labels import CATEGORIES
from prunus.model import Bools, Floats, Ints

BINS = 10
PAPER = {
    "validity_accuracy": 0.898, "category_accuracy": 0.591,
    "valid": (0.949, 0.917), "invalid": (0.754, 0.837),
    "trunk": (0.579, 0.609), "support": (0.570, 0.564), "leader": (0.917, 0.513),
    "side_branch": (0.549, 0.633), "other": (0.483, 0.663),
}  # fmt: skip
"""What the paper has on its test set: accuracies; precision and recall by class."""


def measures(confidence: Floats, category: Ints, truth: Ints) -> dict[str, Any]:
    """Accuracy of validity and category; precision and recall by class; calibration.

    confidence (E,) in [0, 1]; category (E,) the likeliest; truth (E,) -1 where not valid. As in
    the paper the category is judged on valid edges, of those whose category is known.
    """
    valid, said = truth >= 0, confidence > 0.5
    known = valid & (truth < len(CATEGORIES))
    kind, named = category[known], truth[known]
    found = {
        "edges": len(truth),
        "valid_share": float(valid.mean()),
        "validity_accuracy": float((said == valid).mean()),
        "category_accuracy": float((kind == named).mean()) if len(named) else float("nan"),
        "valid": precision_recall(said, valid),
        "invalid": precision_recall(~said, ~valid),
    }
    for k, word in enumerate(CATEGORIES):
        found[word] = precision_recall(kind == k, named == k)
    found["calibration_error"] = calibration_error(confidence, valid)
    return found


def precision_recall(said: Bools, true: Bools) -> tuple[float, float]:
    """TP / (TP + FP) and TP / (TP + FN); NaN of none."""
    hits = float((said & true).sum())
    return tuple(hits / n if n else float("nan") for n in (said.sum(), true.sum()))  # type: ignore[return-value]


def calibration_error(confidence: Floats, valid: Bools) -> float:
    """Expected calibration error: mean gap, over edges, of confidence and share in ten bins."""
    bins = np.minimum((confidence * BINS).astype(np.int64), BINS - 1)
    gap = [abs((confidence - valid)[bins == k].sum()) for k in range(BINS)]
    return float(sum(gap) / len(valid))


def table(validation: dict[str, Any], test: dict[str, Any]) -> list[str]:
    """The paper's two tables as lines of Markdown, the paper's test figures beside ours."""
    lines = ["| | validation | test | paper, test |", "|---|---|---|---|"]
    for key in ("validity_accuracy", "category_accuracy"):
        name = f"edge {key.removesuffix('_accuracy')}"
        lines.append(f"| {name} | {validation[key]:.1%} | {test[key]:.1%} | {PAPER[key]:.1%} |")
    error = (validation["calibration_error"], test["calibration_error"])
    lines.append(f"| calibration error | {error[0]:.3f} | {error[1]:.3f} | - |")
    lines += ["", "| precision / recall | validation | test | paper, test |", "|---|---|---|---|"]
    for key in ("valid", "invalid", *CATEGORIES):
        cells = [f"{a:.1%} / {b:.1%}" for a, b in (validation[key], test[key], PAPER[key])]  # type: ignore[misc]
        lines.append(f"| {key.replace('_', ' ')} | {' | '.join(cells)} |")
    return lines
