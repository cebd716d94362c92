"""`labels.jsonl`: what a person said of candidate edges; the one module that reads and writes it.

A head line says from what scan and with what parameters the graph was made, so that it can be made
again; then a line a label, in the order in which they were given. The last line on an edge counts;
one without a verdict (`"valid": null`) takes the edge's label back.
"""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from prunus.errors import PrunusError
from prunus.files.jsonl import append_line, read_lines_of
from prunus.files.reading import read_bytes, record_of
from prunus.files.work_folder import LABELS
from prunus.io.clouds.units import Unit
from prunus.io.skeletons.skeleton_file import InputRecord, Point

Category = Literal["trunk", "support", "leader", "side_branch", "other"]
CATEGORIES: tuple[Category, ...] = ("trunk", "support", "leader", "side_branch", "other")
"""What a valid edge can be: a label, or wood that is none of them (shoots on trunk or supports)."""


class LabelHead(BaseModel):
    """The first line: what the candidate graph was made from, and how.

    `base` is the point of the file's frame that was given for it, None where it was found; `unit`
    the unit of the file, as it was said.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    format: Literal["prunus-edge-labels"] = "prunus-edge-labels"
    version: Literal[1] = 1
    input: InputRecord
    params: dict[str, Any]
    seed: int = Field(ge=0)
    frame: str
    unit: Unit | None = None
    base: Point | None = None
    version_of_prunus: str | None = None

    @property
    def graph(self) -> dict[str, Any]:
        """All that the graph depends on."""
        return self.model_dump(exclude={"version_of_prunus", "input"}) | {
            "sha256": self.input.sha256
        }


class EdgeLabel(BaseModel):
    """What was said of the edge between two superpoints, i < j, at xyz in the file's frame.

    valid: None takes the label back. category: of a valid edge; None = not said.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    edge: tuple[int, int]
    xyz: tuple[Point, Point]
    valid: bool | None
    category: Category | None = None

    @model_validator(mode="after")
    def _makes_sense(self) -> EdgeLabel:
        first, second = self.edge
        if not 0 <= first < second:
            raise ValueError(f"edge is [{first}, {second}]; expected [i, j] with 0 <= i < j")
        if self.category is not None and not self.valid:
            raise ValueError(f"category is {self.category!r} of an edge that is not valid")
        return self


@dataclass(frozen=True)
class Labels:
    """The labels of one tree: of each edge the last, those taken back left out."""

    path: Path
    head: LabelHead
    labels: list[EdgeLabel]


def append_label(path: str | Path, head: LabelHead, label: EdgeLabel) -> None:
    """Add a label to a file, which is begun with `head` where there is none; safe on the disk.

    PrunusError where the file cannot be written, or holds the labels of another graph.
    """
    path = Path(path)
    if path.exists() and path.stat().st_size:
        _check_same(path, head)
    at = datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
    append_line(path, {"at": at, **label.model_dump()}, first=head.model_dump())


def read_labels(path: str | Path) -> Labels:
    """The labels of a file; a torn last line is left out.

    PrunusError naming file and line where anything else is wrong.
    """
    path = Path(path)
    lines = read_lines_of(path)
    if not lines:
        raise PrunusError(f"{path}: no whole line in it; expected the labels of candidate edges")
    head = record_of(LabelHead, lines[0][1], f"{path}: line 1")
    last: dict[tuple[int, int], EdgeLabel] = {}
    for number, line in lines[1:]:
        told = {name: value for name, value in line.items() if name != "at"}
        label = record_of(EdgeLabel, told, f"{path}: line {number}")
        last.pop(label.edge, None)
        if label.valid is not None:
            last[label.edge] = label
    return Labels(path, head, list(last.values()))


def labels_in(folder: Path) -> list[Path]:
    """The label files of a folder of trees, NAME/labels.jsonl, by name; its own where it is one.

    Those without a whole line were never begun.
    """
    own = folder / LABELS
    found = [own] if own.is_file() else sorted(folder.glob("*/labels.jsonl"))
    return [path for path in found if b"\n" in read_bytes(path, empty=True)]


def _check_same(path: Path, head: LabelHead) -> None:
    """Raise where a file that is there holds the labels of another graph; a torn head is none."""
    lines = read_lines_of(path)
    if not lines:
        return
    there = record_of(LabelHead, lines[0][1], f"{path}: line 1")
    differing = [name for name, value in head.graph.items() if there.graph[name] != value]
    if differing:
        raise PrunusError(
            f"{path}: holds the labels of another graph ({differing[0]} differs); move it away "
            "to begin again"
        )
