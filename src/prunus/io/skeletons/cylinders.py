"""A cylinder for each edge, as tables: for SimpleForest's readers, and for TreeQSM's."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from prunus.files.safely import write_bytes
from prunus.io.tables import csv_bytes
from prunus.model import Floats, Ints, Label, Skeleton
from prunus.model.branches import branch_of_rows, branches, orders


@dataclass(frozen=True, eq=False, kw_only=True)
class Cylinders:
    """The edges (C,) of a skeleton as wood: edge c ends in row c + 1.

    start, end, axis (C, 3); length, radius (C,) metres, the radius the mean of both ends; `parent`
    (C,) the cylinder on which each stands, -1 = none; `branch` (C,) from 0, its `order`, and
    `position` (C,) in it from 0; `segment` (C,) from 0: a segment is what of a branch lies between
    two forks.
    """

    start: Floats
    end: Floats
    axis: Floats
    length: Floats
    radius: Floats
    parent: Ints
    branch: Ints
    order: Ints
    position: Ints
    segment: Ints
    label: list[str]

    @classmethod
    def of(cls, skeleton: Skeleton) -> Cylinders:
        """The cylinders of a skeleton; one that starts a branch has the radius at its end."""
        above = skeleton.parent[1:]
        found = branches(skeleton)
        branch = branch_of_rows(found, len(skeleton))
        position = np.zeros(len(skeleton), np.int64)
        for one in found:
            position[one.rows[1:]] = np.arange(len(one.rows) - 1)
        before = np.where(position[1:] > 0, skeleton.radius[above], skeleton.radius[1:])
        length = skeleton.lengths[1:]
        alone = np.bincount(above, minlength=len(skeleton))[above] == 1
        starts = (position[1:] == 0) | ~alone
        segment = np.zeros(len(above), np.int64)
        segment[starts] = np.arange(starts.sum())
        for row in np.flatnonzero(~starts):
            segment[row] = segment[above[row] - 1]
        return cls(
            start=skeleton.xyz[above],
            end=skeleton.xyz[1:],
            axis=skeleton.edge_vectors[1:] / np.maximum(length, 1e-12)[:, None],
            length=length,
            radius=(before + skeleton.radius[1:]) / 2,
            parent=above - 1,
            branch=branch[1:],
            order=orders(found, len(skeleton))[branch[1:]],
            position=position[1:],
            segment=segment,
            label=[Label(label).word for label in skeleton.label[1:]],
        )


def write_cylinders(path: str | Path, skeleton: Skeleton) -> None:
    """SimpleForest's columns, numbers from 0, parents -1 = none; then label and confidence."""
    made = Cylinders.of(skeleton)
    carrier = np.where(made.parent < 0, -1, made.segment[made.parent])
    first = np.unique(made.segment, return_index=True)[1]
    columns: dict[str, Any] = {
        "ID": np.arange(len(made.length)),
        "parentID": made.parent,
        **{f"start{axis}": made.start[:, k] for k, axis in enumerate("XYZ")},
        **{f"end{axis}": made.end[:, k] for k, axis in enumerate("XYZ")},
        "radius": made.radius,
        "length": made.length,
        "branchOrder": made.order,
        "branchID": made.branch,
        "segmentID": made.segment,
        "parentSegmentID": carrier[first][made.segment],
        "label": made.label,
        "confidence": skeleton.confidence[1:],
    }
    _write(path, columns)


def write_treeqsm(path: str | Path, skeleton: Skeleton) -> None:
    """TreeQSM's cylinders, numbers from 1, 0 = none: the 15 columns that aRchi wants, in its order.

    TreeQSM's measures of fit (mad, SurfCov) are not there; nothing is `added`.
    """
    made = Cylinders.of(skeleton)
    extension = np.zeros(len(made.length), np.int64)
    follows = np.flatnonzero(made.position > 0)
    extension[made.parent[follows]] = follows + 1
    columns: dict[str, Any] = {
        "radius": made.radius,
        "length": made.length,
        **{f"start.{axis}": made.start[:, k] for k, axis in enumerate("xyz")},
        **{f"axis.{axis}": made.axis[:, k] for k, axis in enumerate("xyz")},
        "parent": made.parent + 1,
        "extension": extension,
        "added": np.zeros(len(made.length), np.int64),
        "UnmodRadius": made.radius,
        "branch": made.branch + 1,
        "BranchOrder": made.order,
        "PositionInBranch": made.position + 1,
    }
    _write(path, columns)


def _write(path: str | Path, columns: dict[str, Any]) -> None:
    """A row a cylinder; numbers to the micrometre."""
    rows = zip(*(np.asarray(column).tolist() for column in columns.values()), strict=True)
    records = [dict(zip(columns, map(_short, row), strict=True)) for row in rows]
    write_bytes(Path(path), csv_bytes(records))


def _short(value: Any) -> Any:
    """A number to six decimals; None where it is unknown."""
    if not isinstance(value, float):
        return value
    return None if np.isnan(value) else round(value, 6)
