"""The labelled skeleton: a table of nodes in which a cycle cannot be written down."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import IntEnum
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from prunus.errors import PrunusError
from prunus.model.arrays import Bools, Floats, Ints, frozen
from prunus.model.cloud import RigidMotion

if TYPE_CHECKING:
    import networkx


class Label(IntEnum):
    """What a piece of wood is. The value is the paper's Order (sec. Topological constraints)."""

    TRUNK = 0
    SUPPORT = 1
    LEADER = 2
    SIDE_BRANCH = 3

    @property
    def word(self) -> str:
        """The name in files: trunk, support, leader, side_branch."""
        return self.name.lower()

    @classmethod
    def from_word(cls, word: str) -> Label:
        """The label of that name; PrunusError for any other word."""
        label = cls.__members__.get(str(word).upper())
        if label is None:
            raise PrunusError(f"unknown label {word!r}; expected one of {[x.word for x in cls]}")
        return label


def parents_first(base: int, before: dict[int, int]) -> tuple[list[int], list[int]]:
    """The nodes of a tree, the base first, and the row (M,) of the one before each; -1 first.

    `before` is the node before each node; those of one node come in its order.
    """
    below: dict[int, list[int]] = {}
    for node, above in before.items():
        below.setdefault(above, []).append(node)
    nodes, parent = [base], [-1]
    for row, node in enumerate(nodes):
        for child in below.get(node, []):
            nodes.append(child)
            parent.append(row)
    return nodes, parent


COLUMNS: dict[str, type] = {
    "parent": np.int64,
    "label": np.int8,
    "confidence": np.float64,
    "radius": np.float64,
    "superpoint": np.int64,
}
"""What a skeleton knows of each node beside its place."""


def _column(name: str, values: ArrayLike, rows: int) -> NDArray[Any]:
    return frozen(values, COLUMNS[name], (rows,), name)


@dataclass(frozen=True, eq=False)
class Lines:
    """Points (N, 3), metres, and edges (E, 2) between them: what any skeleton is."""

    xyz: Floats
    edges: Ints


@dataclass(frozen=True, eq=False, kw_only=True)
class Skeleton:
    """A tree of M nodes: row 0 is the base, and every other row hangs on an earlier one.

    xyz (M, 3) metres; parent (M,) with parent[i] < i and -1 at row 0; label (M,) of the edge from
    the parent (row 0 repeats that of the first edge); confidence (M,) of that edge, NaN = unknown;
    radius (M,) metres, NaN = unknown; superpoint (M,), -1 = none.
    """

    xyz: Floats
    parent: Ints
    label: NDArray[np.int8]
    confidence: Floats
    radius: Floats
    superpoint: Ints

    def __post_init__(self) -> None:
        object.__setattr__(self, "xyz", frozen(self.xyz, np.float64, (None, 3), "xyz"))
        for name in COLUMNS:
            object.__setattr__(self, name, _column(name, getattr(self, name), len(self.xyz)))
        self._check()

    def _check(self) -> None:
        if len(self) == 0:
            raise PrunusError("a skeleton has at least its base; found no nodes")
        if not np.isfinite(self.xyz).all():
            raise PrunusError("a skeleton's nodes are finite; found NaN or infinity")
        rows = np.arange(len(self))
        bad = (self.parent >= rows) | (self.parent < np.where(rows == 0, -1, 0))
        if bad.any():
            row = int(bad.argmax())
            raise PrunusError(
                f"parent[{row}] is {self.parent[row]}; "
                "expected -1 at row 0 and an earlier row elsewhere"
            )
        if not np.isin(self.label, [int(label) for label in Label]).all():
            raise PrunusError(f"labels are 0 to {max(Label)}; found {np.unique(self.label)}")

    @classmethod
    def build(
        cls,
        xyz: ArrayLike,
        parent: ArrayLike,
        label: ArrayLike,
        *,
        confidence: ArrayLike | None = None,
        radius: ArrayLike | None = None,
        superpoint: ArrayLike | None = None,
    ) -> Skeleton:
        """A skeleton from its columns; what is not given is unknown.

        Raises PrunusError naming the column that is of a wrong shape or kind.
        """
        nodes = frozen(xyz, np.float64, (None, 3), "xyz")
        rows, unknown = len(nodes), np.full(len(nodes), np.nan)
        return cls(
            xyz=nodes,
            parent=_column("parent", parent, rows),
            label=_column("label", label, rows),
            confidence=unknown if confidence is None else _column("confidence", confidence, rows),
            radius=unknown if radius is None else _column("radius", radius, rows),
            superpoint=np.full(rows, -1)
            if superpoint is None
            else _column("superpoint", superpoint, rows),
        )

    def __len__(self) -> int:
        return len(self.xyz)

    @property
    def edges(self) -> Ints:
        """Edges (M - 1, 2), parent -> child; edge i ends in row i + 1."""
        return np.column_stack([self.parent[1:], np.arange(1, len(self))])

    @property
    def edge_vectors(self) -> Floats:
        """(M, 3) from the parent to the node; zero at row 0."""
        vectors = self.xyz - self.xyz[np.maximum(self.parent, 0)]
        vectors[0] = 0.0
        return np.asarray(vectors)

    @property
    def lengths(self) -> Floats:
        """Length (M,) of the edge from the parent, metres; 0 at row 0."""
        return np.asarray(np.linalg.norm(self.edge_vectors, axis=1))

    def edges_with(self, label: Label) -> Bools:
        """Which rows (M,) end an edge of that label (never row 0)."""
        chosen: Bools = self.label == label
        chosen[0] = False
        return chosen

    def with_radius(self, radius: ArrayLike) -> Skeleton:
        """The same skeleton with other radii (M,)."""
        return replace(self, radius=_column("radius", radius, len(self)))

    def part(self, kept: Bools) -> Skeleton:
        """The tree of these rows (M,), whose parents are among them save that of the first."""
        rows = np.flatnonzero(kept)
        parent = (np.cumsum(kept) - 1)[self.parent[rows]]
        parent[0] = -1
        return Skeleton(
            xyz=self.xyz[rows],
            parent=parent,
            label=self.label[rows],
            confidence=self.confidence[rows],
            radius=self.radius[rows],
            superpoint=self.superpoint[rows],
        )

    def moved(self, motion: RigidMotion) -> Skeleton:
        """The same skeleton in another frame."""
        return replace(self, xyz=motion.apply(self.xyz))

    def to_networkx(self) -> networkx.DiGraph[int]:
        """A networkx DiGraph, parent -> child, which all writers of networkx take.

        Nodes carry `x`, `y`, `z`, `radius` and `superpoint`; edges `label` (word), `confidence` and
        `length`. What is unknown has no entry: formats do not agree on how NaN is written.
        """
        import networkx as nx

        graph: Any = nx.DiGraph()
        for row in range(len(self)):
            place = dict(zip("xyz", self.xyz[row].tolist(), strict=True))
            radius = _if_known(radius=float(self.radius[row]))
            graph.add_node(row, **place, **radius, superpoint=int(self.superpoint[row]))
        for row in range(1, len(self)):
            graph.add_edge(
                int(self.parent[row]),
                row,
                label=Label(self.label[row]).word,
                **_if_known(confidence=float(self.confidence[row])),
                length=float(self.lengths[row]),
            )
        return graph


def _if_known(**values: float) -> dict[str, float]:
    return {name: value for name, value in values.items() if not np.isnan(value)}
