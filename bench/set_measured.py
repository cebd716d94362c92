"""Scans of trees that people measured in orchards: for testing only, nothing is tuned on them.

The folder holds NAME_front.ply, NAME_round.ply and NAME_truth.npz: a, b (S, 3) the ends of each
piece and r (S,) its radius, metres, Z up, the foot at a[0]. Their wood has no labels.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from bench.set_figures import Figures, known
from bench.set_methods import Found
from prunus.io.clouds.cloud_file import read_cloud
from prunus.lab.evaluate.along import pieces_of
from prunus.lab.evaluate.curves import covered, sampled_lines
from prunus.model import Floats, Lines

THICK_M = 0.02  # radius
NEAR_M = 0.05
SEEN_M = 0.02  # wood is shown where a point is so near to its surface
FOOT_M = 0.05
WHOLE = 0.95  # a tree of which less is kept was taken apart


@dataclass(frozen=True, eq=False)
class Measured:
    """Points (P, 3); places (T, 3) every centimetre of the axes that are shown, and radii (T,).

    `every` (A, 3) are the places of all axes, shown or not; `foot` (3,) the lowest.
    """

    name: str
    xyz: Floats
    axis: Floats
    radius: Floats
    foot: Floats
    every: Floats


def measured_in(folder: Path) -> list[Measured]:
    """All scans of a folder, by name."""
    paths = sorted([*folder.glob("*_front.ply"), *folder.glob("*_round.ply")])
    if not paths:
        sys.exit(f"bench.sets: {folder}: no NAME_front.ply or NAME_round.ply in it")
    return [_read(path) for path in paths]


def _read(path: Path) -> Measured:
    xyz = read_cloud(path).xyz
    with np.load(path.with_name(path.stem.rsplit("_", 1)[0] + "_truth.npz")) as held:
        a, b, r = held["a"], held["b"], held["r"]
    edges = np.column_stack([np.arange(len(a)), np.arange(len(a)) + len(a)])
    axis, piece = sampled_lines(Lines(np.concatenate([a, b]), edges))
    shown = cKDTree(xyz).query(axis)[0] <= r[piece] + SEEN_M
    return Measured(path.stem, xyz, axis[shown], r[piece[shown]], a[0], axis)


def measured_figures(case: Measured, found: Found | None) -> Figures:
    """What is found of the shown axes within 5 cm, what of the skeleton is right, the foot."""
    ours = np.zeros((0, 3)) if found is None else pieces_of(found.skeleton).xyz
    thick = case.radius >= THICK_M
    figures = {
        "failed": float(found is None),
        "length": covered(case.axis, ours, NEAR_M),
        "thick": covered(case.axis[thick], ours, NEAR_M),
        "precision": covered(ours, case.every, NEAR_M),
        "f1 2": _f1(covered(case.axis, ours, 0.02), covered(ours, case.every, 0.02)),
    }
    if found is None:
        return figures | {"foot": 0.0}
    away = float(np.linalg.norm(found.skeleton.xyz[0] - case.foot))
    figures |= {"foot": float(away <= FOOT_M), "away": away}
    if found.kept is not None:
        figures["apart"] = float(found.kept.mean() < WHOLE)
    return figures


def _f1(recall: float, precision: float) -> float:
    return 2 * recall * precision / (recall + precision) if recall > 0 else 0.0


def measured_lines(records: Sequence[Figures]) -> dict[str, str]:
    """What is printed of them."""
    rows = {
        "length found within 5 cm, mean / worst": "length",
        "thick wood found (radius from 2 cm), mean / worst": "thick",
        "precision within 5 cm, mean / worst": "precision",
        "F1 at 2 cm, mean / worst": "f1 2",
    }
    lines = {title: _mean_worst(known(records, name)) for title, name in rows.items()}
    feet, apart, away = (known(records, name) for name in ("foot", "apart", "away"))
    spent = known(records, "cpu")
    return lines | {
        "foot within 5 cm": f"{sum(feet):.0f} of {len(feet)}",
        "foot, m off, median / worst": f"{np.median(away):.2f} / {max(away):.2f}" if away else "-",
        "taken apart": f"{sum(apart):.0f} of {len(apart)}" if apart else "-",
        "failed": f"{sum(r['failed'] for r in records):.0f} of {len(records)}",
        "CPU s, median / worst": f"{np.median(spent):.2f} / {max(spent):.2f}",
    }


def _mean_worst(values: list[float]) -> str:
    return f"{np.mean(values):.3f} / {min(values):.3f}" if values else "-"
