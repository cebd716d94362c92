"""Skeletons as wood: a closed tube of triangles for each branch."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from prunus.geometry.vectors import unit
from prunus.io.skeletons.named import names_of
from prunus.model import Floats, Ints, Label, Skeleton
from prunus.model.branches import branches

SIDES = 12
"""Corners of the ring around a node."""

TINY = 1e-9
"""Metres: nodes so near to each other are one."""


@dataclass(frozen=True, eq=False)
class Tube:
    """A closed mesh: vertices and their outward normals (V, 3), faces (F, 3) counter-clockwise.

    `name` is that of its branch, as in `leader 3`.
    """

    name: str
    label: Label
    vertices: Floats
    normals: Floats
    faces: Ints


def tubes(skeleton: Skeleton, named: Mapping[int, str] | None = None) -> list[Tube]:
    """A tube for each branch that has a length, of a skeleton whose radii are all known.

    A branch starts inside the wood that carries it, as thick as at its own first node. `named`: the
    names of branches by the node after their first; others are numbered along X, as everywhere
    where X runs along the row.
    """
    made = []
    for branch, name in zip(branches(skeleton), names_of(skeleton, named or {}), strict=True):
        line, radius = skeleton.xyz[branch.rows], skeleton.radius[branch.rows]
        radius[0] = radius[1] if branch.rows[0] > 0 else radius[0]
        apart = np.linalg.norm(np.diff(line, axis=0), axis=1) > TINY
        if apart.any():
            moves = np.concatenate([[True], apart])
            made.append(Tube(name, branch.label, *tube_around(line[moves], radius[moves])))
    return made


def tube_around(line: Floats, radius: Floats) -> tuple[Floats, Floats, Ints]:
    """Vertices, normals (V, 3) and faces (F, 3) around a line (R, 3), radius (R,), ends closed."""
    tangents, sides, ups = frames_along(line)
    angle = np.arange(SIDES) * (2 * np.pi / SIDES)
    out = np.cos(angle)[:, None] * sides[:, None] + np.sin(angle)[:, None] * ups[:, None]
    rings = line[:, None] + radius[:, None, None] * out
    vertices = np.concatenate([rings.reshape(-1, 3), line[[0, -1]]])
    normals = np.concatenate([out.reshape(-1, 3), -tangents[:1], tangents[-1:]])
    return vertices, normals, _faces(len(line))


def frames_along(line: Floats) -> tuple[Floats, Floats, Floats]:
    """Tangents and two normals (R, 3 each), carried along a line (R, 3) without twist.

    Each normal is turned by the least rotation from one tangent to the next (parallel transport).
    """
    steps = unit(np.diff(line, axis=0))
    both = steps[:-1] + steps[1:]
    straight_back = np.linalg.norm(both, axis=1, keepdims=True) < TINY
    both = np.where(straight_back, steps[1:], both)
    tangents = unit(np.concatenate([steps[:1], both, steps[-1:]]))
    sides = np.empty_like(line)
    across = np.eye(3)[np.abs(tangents[0]).argmin()]
    sides[0] = unit(np.cross(tangents[0], across))
    for row in range(1, len(line)):
        before, after = tangents[row - 1 : row + 1]
        lean = sides[row - 1] @ after / max(1 + before @ after, TINY)
        sides[row] = unit(sides[row - 1] - lean * (before + after))
    return tangents, sides, np.cross(tangents, sides)


def _faces(rings: int) -> Ints:
    """The triangles of so many rings, then those of both ends, whose middles come last."""
    here = np.arange(SIDES)
    there = np.roll(here, -1)
    quads = np.concatenate([np.column_stack([here, there, there + SIDES]),
                            np.column_stack([here, there + SIDES, here + SIDES])])  # fmt: skip
    wall = (quads[None] + SIDES * np.arange(rings - 1)[:, None, None]).reshape(-1, 3)
    first, last = rings * SIDES, rings * SIDES + 1
    foot = np.column_stack([there, here, np.full(SIDES, first)])
    top = np.column_stack([here, there, np.full(SIDES, last)])
    top[:, :2] += SIDES * (rings - 1)
    return np.concatenate([wall, foot, top])
