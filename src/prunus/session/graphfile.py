"""One file for what the machine made of a cloud: superpoints, what joins them, its skeleton.

The file holds no points: those are taken from the scan by their rows.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from prunus import __version__
from prunus.errors import PrunusError
from prunus.files.reading import json_of, record_of
from prunus.geometry.near import within
from prunus.io.arrays import Arrays, finite, indices, read_arrays, shares, there, write_arrays
from prunus.model import (
    CandidateGraph,
    Floats,
    Ints,
    Kind,
    Label,
    PointCloud,
    ScoredGraph,
    SeededGraph,
    Skeleton,
    Superpoints,
)
from prunus.model.isolated import Isolated
from prunus.params import Parameters
from prunus.result import Result

Row = tuple[float, float, float]
COLUMNS = tuple(column.name for column in fields(Skeleton))


class GraphRecord(BaseModel):
    """What a file says beside its arrays.

    `points` are those of the cloud that the machine was given; `to_house` the rotation from the
    frame of the scan's file; `origin` where the house frame has it: in the middle of the points, or
    at the place of the grid there (older files do not say); `isolated_at` and `foot` are of
    isolation, null for none; `rival` of older files.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)

    format: Literal["prunus-graph"] = "prunus-graph"
    version: Literal[1] = 1
    points: int
    to_house: tuple[Row, Row, Row]
    origin: Literal["middle", "grid"] = "middle"
    radius: Annotated[float, Field(gt=0)]
    scorer: str
    base: Annotated[int, Field(ge=0)]
    score: float | None
    warnings: list[str]
    notes: list[str]
    isolated_at: Row | None
    foot: Row | None
    rival: Row | None = None
    version_of_prunus: str


@dataclass(frozen=True, eq=False)
class GraphFile:
    """A file that was read: its arrays are looked over when a result is made of them."""

    path: Path
    record: GraphRecord
    arrays: Arrays

    @property
    def to_house(self) -> Floats:
        """The rotation (3, 3) from the frame of the scan's file to the house frame."""
        return np.array(self.record.to_house)

    def result(self, cloud: PointCloud, params: Parameters, seed: int) -> Result:
        """What the machine made of a cloud. Raises PrunusError where it cannot be of that."""
        told = self.record
        try:
            if told.points != len(cloud):
                raise ValueError(f"is of {told.points} points; expected {len(cloud)}")
            graph = _graph(self.arrays, told, cloud)
            skeleton = _skeleton(self.arrays, len(graph.xyz))
            isolated = _isolated(self.arrays, told)
            history = finite(self.arrays, "history")
        except ValueError as error:
            raise PrunusError(f"{self.path}: {error}") from error
        return Result(
            in_house=skeleton,
            graph=graph,
            score=told.score,
            history=history,
            seconds={},
            params=params,
            seed=seed,
            warnings=told.warnings,
            notes=told.notes,
            scan=cloud,
            isolated=isolated,
        )


def read_graph(path: Path) -> GraphFile:
    """Read a file. Raises PrunusError where it is none."""
    arrays, told = read_arrays(path)
    record = record_of(GraphRecord, json_of(told, path), path, "told")
    turn = np.array(record.to_house)
    if not np.allclose(turn @ turn.T, np.eye(3), atol=1e-9) or np.linalg.det(turn) < 0:
        raise PrunusError(f"{path}: told.to_house: expected a rotation")
    return GraphFile(path, record, arrays)


def write_graph(path: Path, result: Result) -> None:
    """Write what the machine made of a cloud. Raises PrunusError where that cannot be done."""
    graph, own, isolated = result.graph, result.graph.superpoints, result.isolated
    arrays = {
        "steps": np.diff(rows_of(own.cloud.xyz, result.scan.xyz), prepend=0),
        "xyz": own.xyz,
        "edges": graph.edges,
        "confidence": graph.confidence,
        "category": graph.scored.category,
        "tips": graph.tips,
        "history": result.history,
        "kind": np.zeros(0, np.int64) if isolated is None else isolated.kind,
        **_members(result),
        **{f"skeleton_{name}": getattr(result.in_house, name) for name in COLUMNS},
    }
    told = {
        "points": len(result.scan),
        "to_house": _row(map(_row, result.scan.to_input.rotation.T.tolist())),
        "origin": "grid",
        "radius": own.radius,
        "scorer": graph.scored.scorer,
        "base": graph.base,
        "score": result.score,
        "warnings": result.warnings,
        "notes": result.notes,
        "isolated_at": _place(None if isolated is None else isolated.foot),
        "foot": _place(None if isolated is None else isolated.foot),
        "version_of_prunus": __version__,
    }
    write_arrays(path, arrays, GraphRecord.model_validate(told).model_dump_json())


def rows_of(part: Floats, whole: Floats) -> Ints:
    """A row (Q,) of `whole` (P, 3) for each row of `part` (Q, 3), all of which are in it."""
    both = np.concatenate([whole, part])
    order = np.lexsort(both.T)
    new = np.ones(len(both), np.bool_)
    new[1:] = (both[order[1:]] != both[order[:-1]]).any(axis=1)
    first = np.empty(len(both), np.int64)
    first[order] = order[new][np.cumsum(new) - 1]
    return np.asarray(first[len(whole) :])


def _place(place: Floats | None) -> Row | None:
    return None if place is None else _row(place.tolist())


def _row(values: Any) -> tuple[Any, ...]:
    return tuple(values)


def _graph(arrays: Arrays, told: GraphRecord, cloud: PointCloud) -> SeededGraph:
    drawn = cloud.take(indices(arrays, "steps", len(cloud), steps=True))
    xyz = finite(arrays, "xyz")
    if len(drawn) == 0 or xyz.ndim != 2 or xyz.shape[1] != 3:
        raise ValueError("xyz: expected superpoints (N, 3), and points about them")
    start, members = _members_in(arrays, drawn, xyz, told.radius)
    own = Superpoints(drawn, xyz, start, members, told.radius)
    category = shares(arrays, "category")
    if category.ndim != 2 or category.shape[1] not in (0, len(Label) + 1):
        raise ValueError(f"category: of shape {category.shape}; expected (E, {len(Label) + 1})")
    candidates = CandidateGraph(own, _edges(arrays, len(own)))
    scored = ScoredGraph(
        candidates=candidates,
        confidence=shares(arrays, "confidence"),
        category=category,
        scorer=told.scorer,
    )
    if told.base >= len(own):
        raise ValueError(f"told.base: found {told.base}; there are {len(own)} superpoints")
    return SeededGraph(scored, told.base, indices(arrays, "tips", len(own)))


def _members(result: Result) -> dict[str, Ints]:
    """Which points belong to each node, where they are others than those within the radius."""
    own = result.graph.superpoints
    if result.params.method != "default":
        return {}
    return {"held": np.diff(own.start), "members": own.members}


def _members_in(arrays: Arrays, drawn: PointCloud, xyz: Floats, radius: float) -> tuple[Ints, Ints]:
    """The starts (N + 1,) and points of the nodes (N, 3)."""
    if "members" not in arrays:
        return within(drawn.xyz, xyz, radius)
    members = indices(arrays, "members", len(drawn))
    held = indices(arrays, "held", len(members) + 1)
    if held.shape != (len(xyz),) or members.shape != (held.sum(),):
        raise ValueError("held: expected how many points each node has, of all members")
    return np.concatenate([[0], held.cumsum()]), members


def _edges(arrays: Arrays, count: int) -> Ints:
    """Edges (E, 2) between so many nodes, each once and in order, as the machine has them."""
    pairs = indices(arrays, "edges", count)
    if pairs.ndim != 2 or pairs.shape[1] != 2 or not (pairs[:, 0] < pairs[:, 1]).all():
        raise ValueError("edges: expected pairs of superpoints, the smaller first")
    if not (np.diff(pairs[:, 0] * count + pairs[:, 1]) > 0).all():
        raise ValueError("edges: expected each once, in order")
    return pairs


def _skeleton(arrays: Arrays, count: int) -> Skeleton:
    columns: dict[str, Any] = {name: there(arrays, f"skeleton_{name}") for name in COLUMNS}
    columns["label"] = indices(arrays, "skeleton_label", len(Label))
    nodes = columns["superpoint"] = indices(arrays, "skeleton_superpoint", count)
    if nodes.ndim != 1 or len(np.unique(nodes)) != len(nodes):
        raise ValueError("skeleton_superpoint: expected each once")
    return Skeleton(**columns)


def _isolated(arrays: Arrays, told: GraphRecord) -> Isolated | None:
    if told.isolated_at is None or told.foot is None:
        return None
    kind = indices(arrays, "kind", len(Kind))
    if kind.shape != (told.points,):
        raise ValueError(f"kind: of shape {kind.shape}; expected ({told.points},)")
    return Isolated(kind, np.array(told.foot))
