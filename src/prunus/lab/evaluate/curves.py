"""Curve measures: two labelled trees compared as curves, no graph needed (docs/evaluation.md)."""

from __future__ import annotations

import numpy as np

from prunus.geometry.near import within
from prunus.model import Floats, Ints, Label, Lines, Skeleton

SPACING = 0.01
"""Both trees are sampled every so many metres along their edges."""
TOLERANCE = 0.05
"""A sample is matched by one of the other tree within so many metres."""


def curve_measures(predicted: Skeleton, truth: Skeleton) -> dict[str, float]:
    """`<label>_recall`, `<label>_precision`, `<label>_f1` and the same as `geometry_*`.

    Both skeletons in one frame. NaN where a tree has none of the label.
    """
    found, true = sampled(predicted), sampled(truth)
    measures: dict[str, float] = {}
    for name, label in [("geometry", None), *((label.word, label) for label in Label)]:
        measures |= _measured(name, _of(found, label), _of(true, label))
    return measures


def sampled(skeleton: Skeleton) -> tuple[Floats, Ints]:
    """Points (S, 3) every `SPACING` along the edges, and the label (S,) of each."""
    points, row = sampled_rows(skeleton)
    return points, skeleton.label[row].astype(np.int64)


def sampled_rows(skeleton: Skeleton) -> tuple[Floats, Ints]:
    """Points (S, 3) every `SPACING` along the edges, and the row (S,) in which each edge ends."""
    points, edge = sampled_lines(Lines(skeleton.xyz, skeleton.edges))
    return points, edge + 1


def sampled_lines(lines: Lines) -> tuple[Floats, Ints]:
    """Points (S, 3) every `SPACING` along the edges, and the edge (S,) of each."""
    ends = lines.xyz[lines.edges]
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    steps = np.maximum(1, np.rint(lengths / SPACING).astype(np.int64))
    edge = np.repeat(np.arange(len(ends)), steps)
    within_edge = np.arange(len(edge)) - np.repeat(np.cumsum(steps) - steps, steps)
    share = ((within_edge + 0.5) / np.repeat(steps, steps))[:, None]
    return ends[edge, 1] * share + ends[edge, 0] * (1 - share), edge


def line_measures(predicted: Lines, truth: Lines) -> dict[str, float]:
    """`geometry_recall`, `_precision` and `_f1` of lines without labels, both in one frame."""
    return _measured("geometry", sampled_lines(predicted)[0], sampled_lines(truth)[0])


def _measured(name: str, found: Floats, true: Floats) -> dict[str, float]:
    recall, precision = covered(true, found), covered(found, true)
    both = recall + precision
    f1 = 2 * recall * precision / both if both > 0 else both
    return {f"{name}_recall": recall, f"{name}_precision": precision, f"{name}_f1": f1}


def covered(points: Floats, by: Floats, tolerance: float = TOLERANCE) -> float:
    """Share of the points (S, 3) with one of the others within the tolerance; NaN of none."""
    if len(points) == 0:
        return float("nan")
    if len(by) == 0:
        return 0.0
    start, _ = within(by, points, tolerance)
    return float((np.diff(start) > 0).mean())


def _of(samples: tuple[Floats, Ints], label: Label | None) -> Floats:
    points, labels = samples
    return points if label is None else points[labels == label]
