"""How well a network of the point field does on examples that it has not learned from."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from prunus.field.network import see_field
from prunus.field.votes import PointField
from prunus.lab.learn.field.examples import FieldExample, Lesson, lesson_of
from prunus.lab.simulate.wide.points import UNTOLD
from prunus.model import Floats, Ints, Role

SEED = 0  # of the way in which each example is shown
MOST = 90  # this percentile is told beside the median
ERRORS = {"offset, mm": 1, "radius, %": 1, "direction, degrees": 0}
"""The errors of a voxel of wood, and the digits with which each is told."""
Figures = dict[str, Any]


@dataclass(frozen=True, eq=False)
class Seen:
    """What is true of the voxels (V,) of one example, and what a network says of them."""

    lesson: Lesson
    said: PointField

    @property
    def wood(self) -> Ints:
        """The rows of the voxels of wood."""
        role = self.lesson.role
        return np.flatnonzero((role != Role.NO_WOOD) & (role != UNTOLD))

    def errors(self) -> dict[str, Floats]:
        """The errors of the voxels of wood, by the names of `ERRORS`."""
        rows, true, said = self.wood, self.lesson, self.said
        offset = np.linalg.norm(said.offset[rows] - true.offset[rows], axis=1)
        radius = np.abs(said.radius[rows] / np.maximum(true.radius[rows], 1e-6) - 1)
        length = np.maximum(np.linalg.norm(true.toward_foot[rows], axis=1), 1e-9)
        cosine = (said.toward_foot[rows] * true.toward_foot[rows]).sum(axis=1) / length
        angle = np.degrees(np.arccos(np.clip(cosine, -1, 1)))
        found = (1000 * offset, 100 * radius, angle)
        return {name: one[np.isfinite(one)] for name, one in zip(ERRORS, found, strict=True)}


def figures_of(network: Path, examples: Iterable[Path]) -> Figures:
    """The share of the voxels of each role that are told right; median and 90 % of the errors.

    Of a network in an ONNX file, on examples in files, each shown in one way.
    """
    seen = [_seen(network, path, number) for number, path in enumerate(examples)]
    true = np.concatenate([one.lesson.role for one in seen])
    right = true == np.concatenate([one.said.role.argmax(axis=1) for one in seen])
    found: Figures = {"voxels": int((true >= 0).sum()), "all roles": _share(right[true >= 0])}
    found |= {_word(role): _share(right[true == role]) for role in Role}
    errors = [one.errors() for one in seen]
    for name in ERRORS:
        every = np.concatenate([one[name] for one in errors])
        found[name] = np.percentile(every, [50, MOST]).tolist() if len(every) else None
    return found


def _seen(network: Path, path: Path, number: int) -> Seen:
    rng = np.random.default_rng([SEED, number])
    lesson = lesson_of(FieldExample.read(path).shown(rng))
    return Seen(lesson, see_field(lesson.voxels, network))


def table_of(columns: dict[str, Figures]) -> list[str]:
    """The figures of several networks side by side, as lines of Markdown."""
    names = ["all roles", *map(_word, Role), *ERRORS]
    lines = [f"| | {' | '.join(columns)} |", "|---" * (len(columns) + 1) + "|"]
    for name in names:
        cells = [_cell(name, column[name]) for column in columns.values()]
        label = f"{name}, median / {MOST} %" if name in ERRORS else f"{name}, right"
        lines.append(f"| {label} | {' | '.join(cells)} |")
    return lines


def _cell(name: str, value: Any) -> str:
    if value is None:
        return "-"
    if name in ERRORS:
        return " / ".join(f"{one:.{ERRORS[name]}f}" for one in value)
    return f"{value:.1%}"


def _share(right: Any) -> float | None:
    return float(right.mean()) if len(right) else None


def _word(role: Role) -> str:
    return role.name.lower().replace("_", " ")
