"""Curve measures: two labelled trees compared as curves, no graph needed (measures.md B)."""

from __future__ import annotations

import numpy as np

from prunus.kernels.neighbours import within
from prunus.model import Floats, Ints, Label, Skeleton

SPACING = 0.01
"""Both trees are sampled every so many metres along their edges."""
TOLERANCE = 0.05
"""A sample is matched by one of the other tree within so many metres."""


def curve_measures(predicted: Skeleton, truth: Skeleton) -> dict[str, float]:
    """`<label>_recall`, `<label>_precision`, `<label>_f1` and the same as `geometry_*`.

    Both skeletons in one frame. NaN where a tree has none of the label.
    """
    found, true = sampled(predicted), sampled(truth)
    measures = {}
    for name, label in [("geometry", None), *((label.word, label) for label in Label)]:
        ours, theirs = _of(found, label), _of(true, label)
        recall, precision = covered(theirs, ours), covered(ours, theirs)
        measures[f"{name}_recall"] = recall
        measures[f"{name}_precision"] = precision
        both = recall + precision
        measures[f"{name}_f1"] = 2 * recall * precision / both if both > 0 else both
    return measures


def sampled(skeleton: Skeleton) -> tuple[Floats, Ints]:
    """Points (S, 3) every `SPACING` along the edges, and the label (S,) of each."""
    points, row = sampled_rows(skeleton)
    return points, skeleton.label[row].astype(np.int64)


def sampled_rows(skeleton: Skeleton) -> tuple[Floats, Ints]:
    """Points (S, 3) every `SPACING` along the edges, and the row (S,) in which each edge ends."""
    rows = np.arange(1, len(skeleton))
    steps = np.maximum(1, np.rint(skeleton.lengths[rows] / SPACING).astype(np.int64))
    row = np.repeat(rows, steps)
    within_edge = np.arange(len(row)) - np.repeat(np.cumsum(steps) - steps, steps)
    share = ((within_edge + 0.5) / np.repeat(steps, steps))[:, None]
    points = skeleton.xyz[row] * share + skeleton.xyz[skeleton.parent[row]] * (1 - share)
    return points, row


def covered(points: Floats, by: Floats) -> float:
    """Share of the points (S, 3) with one of the others within the tolerance; NaN of none."""
    if len(points) == 0:
        return float("nan")
    if len(by) == 0:
        return 0.0
    start, _ = within(by, points, TOLERANCE)
    return float((np.diff(start) > 0).mean())


def _of(samples: tuple[Floats, Ints], label: Label | None) -> Floats:
    points, labels = samples
    return points if label is None else points[labels == label]
