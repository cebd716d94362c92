"""`skeleton.json`: the one module that reads and writes it.

Its JSON Schema is schemas/skeleton.json.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, Literal, cast

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from prunus.errors import PrunusError
from prunus.io.safely import path_of, read_marked, write_bytes
from prunus.model import Floats, Label, Skeleton

Word = Literal["trunk", "support", "leader", "side_branch"]
Point = tuple[float, float, float]


class InputRecord(BaseModel):
    """The cloud that a skeleton came from."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    file: str
    sha256: str
    points: int


class BranchTrust(BaseModel):
    """How likely a branch is right."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: str = Field(description="as in the report: leader 3 is the third from the left")
    label: Word
    nodes: list[int] = Field(description="along it, from the node at which it leaves its parent")
    trust: float = Field(description="the probability that it is right")


class TrustRecord(BaseModel):
    """How likely a skeleton is right: docs/trust.md."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    tree: float = Field(description="the share of its edges that likely need no correction")
    edges: list[float | None] = Field(description="that the edge into a node needs none; by node")
    branches: list[BranchTrust]


class SkeletonFile(BaseModel):
    """The contents of `skeleton.json`: one entry a node, whose edge is that from its parent."""

    model_config = ConfigDict(frozen=True, extra="forbid", title="prunus skeleton")

    format: Literal["prunus-skeleton"] = "prunus-skeleton"
    version: Literal[1] = 1
    frame: Literal["file"] = Field("file", description="nodes are in the frame of the input file")
    unit: Literal["m"] = "m"
    nodes: list[Point] = Field(min_length=1, description="x, y, z; the base first")
    parent: list[int] = Field(description="an earlier node; -1 for the base")
    label: list[Word] = Field(description="of the edge from the parent; the base repeats the first")
    confidence: list[float | None] = Field(
        description="of the edge: that wood joins its ends; null = unknown"
    )
    radius: list[float | None] = Field(description="null = unknown")
    superpoint: list[int] = Field(description="index of the superpoint; -1 = none")
    score: float | None = Field(
        None, description="under params.search.score: learned, or SkelScore"
    )
    trust: TrustRecord | None = None
    review: list[str] | None = Field(
        None, description="why a person should look before a machine acts; empty: no need"
    )
    input: InputRecord | None = None
    params: dict[str, Any] | None = None
    seed: int | None = None
    version_of_prunus: str | None = None


EVIDENCE = {name for name, field in SkeletonFile.model_fields.items() if field.default is None}
"""What a file may say beside the skeleton."""


def write_skeleton(path: str | Path, skeleton: Skeleton, **evidence: Any) -> None:
    """Write `skeleton.json`; `evidence`: see `EVIDENCE`."""
    path = path_of(path)
    if not isinstance(skeleton, Skeleton):
        raise PrunusError(f"{path}: {type(skeleton).__name__}; expected a Skeleton to write")
    record = SkeletonFile(
        nodes=skeleton.xyz.tolist(),
        parent=skeleton.parent.tolist(),
        label=[cast(Word, Label(label).word) for label in skeleton.label],
        confidence=_nullable(skeleton.confidence),
        radius=_nullable(skeleton.radius),
        superpoint=skeleton.superpoint.tolist(),
        **evidence,
    )
    rows = record.model_dump()
    lines = [f"  {json.dumps(key)}: {_compact(value)}" for key, value in rows.items()]
    write_bytes(path, ("{\n" + ",\n".join(lines) + "\n}\n").encode())


def read_record(path: str | Path) -> tuple[Skeleton, SkeletonFile]:
    """The skeleton, and all that its file says; PrunusError naming file and field otherwise."""
    path = path_of(path)
    try:
        record = SkeletonFile.model_validate_json(read_marked(path))
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"]) or "the file"
        raise PrunusError(f"{path}: {where}: {first['msg']}") from error
    columns = ("parent", "label", "confidence", "radius", "superpoint")
    for name in columns:
        found = len(getattr(record, name))
        if found != len(record.nodes):
            raise PrunusError(
                f"{path}: {name}: {found} entries; expected one for each of the "
                f"{len(record.nodes)} nodes"
            )
    try:
        skeleton = Skeleton.build(
            record.nodes,
            record.parent,
            [Label.from_word(word) for word in record.label],
            confidence=_known(record.confidence),
            radius=_known(record.radius),
            superpoint=record.superpoint,
        )
    except ValueError as error:
        raise PrunusError(f"{path}: {error}") from error
    return skeleton, record


def read_skeleton(path: str | Path) -> Skeleton:
    """The skeleton of a `skeleton.json`, or of an SWC file, by the ending."""
    from prunus.io.export import read_swc

    path = path_of(path)
    return read_swc(path) if path.suffix.lower() == ".swc" else read_record(path)[0]


def _nullable(values: Floats) -> list[float | None]:
    return [None if np.isnan(value) else value for value in values.tolist()]


def _known(values: list[float | None]) -> list[float]:
    return [np.nan if value is None else value for value in values]


def _compact(value: Any) -> str:
    """JSON on one line, save that long lists of nodes get a line each."""
    if isinstance(value, list) and value and isinstance(value[0], tuple):
        return "[\n    " + ",\n    ".join(json.dumps(row) for row in value) + "\n  ]"
    return json.dumps(value)
