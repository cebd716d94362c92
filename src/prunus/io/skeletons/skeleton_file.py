"""`skeleton.json`: the one module that reads and writes it.

Its JSON Schema is schemas/skeleton.json.
"""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Annotated, Any, Literal, cast

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from prunus.errors import PrunusError
from prunus.files.reading import in_words, record_in
from prunus.files.safely import path_of, write_bytes
from prunus.model import Floats, Label, Skeleton
from prunus.model.branches import branch_of_rows, branches

Word = Literal["trunk", "support", "leader", "side_branch"]
Point = tuple[float, float, float]
Share = Annotated[float, Field(ge=0, le=1)]
Row = Annotated[int, Field(ge=0)]
RowOrNone = Annotated[int, Field(ge=-1, le=2**53)]
DIGITS = 4
"""A probability is written with so many."""


class _Record(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class InputRecord(_Record):
    """The cloud that a skeleton came from."""

    file: str
    sha256: str
    points: int


class ReadRecord(_Record):
    """How the input was asked to be read."""

    frame: str = Field("auto", description="as --frame: docs/frames.md")
    unit: str | None = Field(None, description="as --unit; null = as the file says")


class BranchName(_Record):
    """A branch and how it is called."""

    number: Row | None = Field(None, description="the same in every file, see `branch`")
    name: str = Field(
        pattern=r"^[\w ]{1,80}$",
        description="as in the report: leader 3 is the third from the left",
    )
    label: Word
    nodes: list[Row] = Field(description="along it, from the node at which it leaves its parent")
    trust: Share | None = Field(None, description="the probability that it is right")


class BranchTrust(BranchName):
    """How likely a branch is right."""

    trust: Share = Field(description="the probability that it is right")


class TrustRecord(_Record):
    """How likely a skeleton is right: docs/trust.md."""

    tree: Share = Field(description="the share of its edges that likely need no correction")
    edges: list[Share | None] = Field(description="that the edge into a node needs none; by node")
    branches: list[BranchTrust]


class SkeletonFile(_Record):
    """The contents of `skeleton.json`: one entry a node, whose edge is that from its parent."""

    model_config = ConfigDict(title="prunus skeleton")

    format: Literal["prunus-skeleton"] = "prunus-skeleton"
    version: Literal[1, 2] = Field(2, description="2 has all that 1 has, and more")
    frame: Literal["file"] = Field("file", description="nodes are in the frame of the input file")
    unit: Literal["m"] = "m"
    nodes: list[Point] = Field(min_length=1, description="x, y, z; the base first")
    parent: list[RowOrNone] = Field(description="an earlier node; -1 for the base")
    label: list[Word] = Field(description="of the edge from the parent; the base repeats the first")
    confidence: list[Share | None] = Field(
        description="of the edge: that wood joins its ends; null = unknown"
    )
    radius: list[Annotated[float, Field(ge=0)] | None] = Field(description="null = unknown")
    superpoint: list[RowOrNone] = Field(description="index of the superpoint; -1 = none")
    branch: list[RowOrNone] | None = Field(
        None,
        description="number of the branch of the edge: the same before and after refining, and in "
        "plans, traits and meshes; -1 for the base; null = counted as branches leave",
    )
    radius_error: list[Annotated[float, Field(ge=0)] | None] | None = Field(
        None, description="one standard deviation of the radius; null = unknown"
    )
    seen: list[bool] | None = Field(None, description="whether the scan has points there")
    score: float | None = Field(
        None, description="SkelScore of the paper's method; null where the method has none"
    )
    trust: TrustRecord | None = None
    review: list[str] | None = Field(
        None, description="why a person should look before a machine acts; empty: no need"
    )
    branches: list[BranchName] | None = Field(
        None, description="their names, where others than a count along X"
    )
    refines: str | None = Field(
        None, description="sha256 of the skeleton that was refined to this one: docs/files.md"
    )
    input: InputRecord | None = None
    read: ReadRecord | None = None
    params: dict[str, Any] | None = None
    seed: int | None = None
    version_of_prunus: str | None = None

    @property
    def named(self) -> dict[int, str]:
        """The names that the file gives to branches, each by the node after its first."""
        told = self.branches or (self.trust.branches if self.trust else [])
        return {branch.nodes[1]: branch.name for branch in told if len(branch.nodes) > 1}

    @property
    def likely(self) -> Floats:
        """How likely the branch of each node (M,) is right; NaN where the file does not say."""
        likely = np.full(len(self.nodes), np.nan)
        for branch in [*(self.branches or []), *(self.trust.branches if self.trust else [])]:
            if branch.trust is not None:
                likely[branch.nodes[1:]] = branch.trust
        return likely


EVIDENCE = {name for name, field in SkeletonFile.model_fields.items() if field.default is None} - {
    "branch"
}
"""What a file may say beside the skeleton."""


def write_skeleton(path: str | Path, skeleton: Skeleton, **evidence: Any) -> None:
    """Write `skeleton.json`; `evidence`: see `EVIDENCE`.

    PrunusError where it cannot be written, or a confidence or radius is none.
    """
    path = path_of(path)
    if not isinstance(skeleton, Skeleton):
        raise PrunusError(f"{path}: {type(skeleton).__name__}; expected a Skeleton to write")
    with in_words(path, SkeletonFile):
        record = SkeletonFile(
            nodes=skeleton.xyz.tolist(),
            parent=skeleton.parent.tolist(),
            label=[cast(Word, Label(label).word) for label in skeleton.label],
            confidence=nullable(skeleton.confidence),
            radius=nullable(skeleton.radius),
            superpoint=skeleton.superpoint.tolist(),
            branch=branch_of_rows(branches(skeleton), len(skeleton)).tolist(),
            **evidence,
        )
    rows = record.model_dump()
    lines = [f"  {json.dumps(key)}: {_compact(value)}" for key, value in rows.items()]
    write_bytes(path, ("{\n" + ",\n".join(lines) + "\n}\n").encode())


def read_record(path: str | Path) -> tuple[Skeleton, SkeletonFile]:
    """The skeleton, and all that its file says; PrunusError naming file and field otherwise."""
    path = path_of(path)
    record = record_in(path, SkeletonFile)
    _check_lengths(record, path)
    try:
        skeleton = Skeleton.build(
            record.nodes,
            record.parent,
            [Label.from_word(word) for word in record.label],
            confidence=known(record.confidence),
            radius=known(record.radius),
            superpoint=record.superpoint,
        )
    except ValueError as error:
        raise PrunusError(f"{path}: {error}") from error
    _check_branches(record, skeleton, path)
    return skeleton, record


def _check_lengths(record: SkeletonFile, path: Path) -> None:
    """Raise where a column does not have an entry a node, or a branch a node that is none."""
    count = len(record.nodes)
    columns = (
        "parent", "label", "confidence", "radius", "superpoint", "branch", "radius_error", "seen",
    )  # fmt: skip
    held = {name: getattr(record, name) for name in columns}
    entries = {name: len(column) for name, column in held.items() if column is not None}
    if record.trust is not None:
        entries["trust.edges"] = len(record.trust.edges)
    for name, found in entries.items():
        if found != count:
            raise PrunusError(
                f"{path}: {name}: {found} entries; expected one for each of the {count} nodes"
            )
    for branch in [*(record.branches or []), *(record.trust.branches if record.trust else [])]:
        if any(row >= count for row in branch.nodes):
            raise PrunusError(
                f"{path}: {branch.name}: node {max(branch.nodes)}; expected 0 to {count - 1}"
            )


def _check_branches(record: SkeletonFile, skeleton: Skeleton, path: Path) -> None:
    """Raise where branches have other numbers than those that parents and labels give them."""
    numbers = branch_of_rows(branches(skeleton), len(skeleton)).tolist()
    if record.branch is None or record.branch == numbers:
        return
    node = next(
        k for k, (one, two) in enumerate(zip(record.branch, numbers, strict=True)) if one != two
    )
    raise PrunusError(
        f"{path}: branch: {record.branch[node]} at node {node}; expected {numbers[node]}, by "
        "parents and labels (leave `branch` out to have them counted anew)"
    )


def sha256_of(skeleton: Skeleton) -> str:
    """The sha256 of places, parents and labels, the same in whatever file a skeleton is kept."""
    whole = hashlib.sha256()
    for column, kind in (
        (skeleton.xyz + 0.0, "<f8"),  # no -0.0
        (skeleton.parent, "<i8"),
        (skeleton.label, "i1"),
    ):
        whole.update(np.ascontiguousarray(column, kind).tobytes())
    return whole.hexdigest()


def read_skeleton(path: str | Path) -> Skeleton:
    """The skeleton of a `skeleton.json`, or of an SWC file, by the ending."""
    from prunus.io.skeletons.swc import read_swc

    path = path_of(path)
    return read_swc(path) if path.suffix.lower() == ".swc" else read_record(path)[0]


def nullable(values: Floats) -> list[float | None]:
    """Numbers as JSON has them: null for NaN."""
    return [None if np.isnan(value) else value for value in values.tolist()]


def known(values: list[float | None]) -> list[float]:
    """The other way round."""
    return [np.nan if value is None else value for value in values]


def _compact(value: Any) -> str:
    """JSON on one line, save that long lists of nodes get a line each."""
    if isinstance(value, list) and value and isinstance(value[0], tuple):
        return "[\n    " + ",\n    ".join(json.dumps(row) for row in value) + "\n  ]"
    return json.dumps(value)
