"""The branches of a skeleton as the rules see them: named, measured from the bark they leave."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from prunus.geometry.exits import exit_along
from prunus.model import Bools, Floats, Ints, Label, Skeleton
from prunus.model.branch_names import branch_names
from prunus.model.branches import Branch, branch_of_rows, branches
from prunus.refine.radii import known_radius

FIRST_CHORD_M, NEXT_CHORD_M = 0.04, 0.12
"""Its bend at the foot is the angle between the chord to the first and that on to the second, by
length along the branch outside of its parent."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Limb:
    """One branch: rows (R,) of the skeleton, `along` (R,) metres from its start on the parent.

    `parent` is the number of the limb that it leaves, -1 at the base; `bark` where along it comes
    out of the parent's bark; `reach` the longest way from there to a tip of what hangs on it.
    """

    number: int
    name: str
    label: Label
    rows: Ints
    xyz: Floats
    along: Floats
    parent: int
    bark: float
    reach: float

    def at(self, along: float) -> Floats:
        """The point (3,) of the axis so many metres from the start."""
        return np.array([np.interp(along, self.along, self.xyz[:, axis]) for axis in range(3)])

    def heading(self, along: float) -> Floats:
        """The unit direction (3,) of the axis there, towards the tip."""
        edge = int(np.clip(np.searchsorted(self.along, along), 1, len(self.rows) - 1))
        vector = self.xyz[edge] - self.xyz[edge - 1]
        return np.asarray(vector / max(float(np.linalg.norm(vector)), 1e-12))

    @property
    def bend(self) -> float:
        """The turn, degrees, between the first of it outside the bark and what comes then."""
        foot, knee, on = (self.at(self.bark + way) for way in (0.0, FIRST_CHORD_M, NEXT_CHORD_M))
        first, then = knee - foot, on - knee
        size = max(float(np.linalg.norm(first) * np.linalg.norm(then)), 1e-12)
        return math.degrees(math.acos(np.clip(first @ then / size, -1, 1)))

    def value_at(self, along: float, values: Floats) -> float:
        """A value (M,) of the skeleton's rows there; NaN where it is unknown on either side.

        The first row belongs to the parent and does not count.
        """
        own = self.along[1:], values[self.rows[1:]]
        return float(np.interp(along, *own))


@dataclass(frozen=True, eq=False, kw_only=True)
class Limbs:
    """A skeleton in the house frame and its branches.

    `measured`: its lengths are what a scan shows, which may hide tips; else they are taken as told.
    """

    skeleton: Skeleton
    all: tuple[Limb, ...]
    owner: Ints
    measured: bool = False

    @classmethod
    def of(
        cls, skeleton: Skeleton, names: list[str] | None = None, *, measured: bool = False
    ) -> Limbs:
        """The limbs of a skeleton in the house frame (Z up); `names` of its branches, if known."""
        found = branches(skeleton)
        owner = branch_of_rows(found, len(skeleton))
        names = names or branch_names(skeleton, found)
        lengths = skeleton.lengths
        far = _farthest(skeleton, lengths)
        limbs: list[Limb] = []
        for number, branch in enumerate(found):
            parent = int(owner[branch.rows[0]])
            above = limbs[parent] if parent >= 0 else None
            name = names[number]
            limbs.append(_limb(
                skeleton, branch, number=number, name=name, parent=parent, above=above, far=far,
                lengths=lengths,
            ))  # fmt: skip
        return cls(skeleton=skeleton, all=tuple(limbs), owner=owner, measured=measured)

    def with_label(self, label: Label) -> list[Limb]:
        """The limbs of a label, by where they stand along the row."""
        some = [limb for limb in self.all if limb.label == label]
        return sorted(some, key=lambda limb: int(limb.name.rpartition(" ")[2] or 0))

    def parent_of(self, limb: Limb) -> Limb | None:
        """The limb that another leaves; None at the base."""
        return self.all[limb.parent] if limb.parent >= 0 else None

    def beyond(self, limb: Limb, along: float) -> Bools:
        """Which rows (M,) come down with what a limb has beyond a place."""
        gone = np.zeros(len(self.skeleton), np.bool_)
        gone[limb.rows[1:][limb.along[1:] > along]] = True
        for other in self.all[limb.number + 1 :]:
            if gone[other.rows[0]]:
                gone[other.rows[1:]] = True
        return gone

    def path_to(self, limb: Limb) -> Ints:
        """The rows whose edges lead from the base to the start of a limb."""
        rows = []
        row = int(limb.rows[0])
        while row > 0:
            rows.append(row)
            row = int(self.skeleton.parent[row])
        return np.array(rows[::-1], np.int64)


def _limb(
    skeleton: Skeleton,
    branch: Branch,
    *,
    number: int,
    name: str,
    parent: int,
    above: Limb | None,
    far: Floats,
    lengths: Floats,
) -> Limb:
    rows = branch.rows
    along = np.concatenate([[0.0], lengths[rows[1:]].cumsum()])
    xyz = skeleton.xyz[rows]
    bark = 0.0
    if above is not None:
        radius = known_radius(skeleton, int(rows[0]), above.label)
        bark = exit_along(xyz, along, above.xyz, radius)
    reach = float(along[1] + far[rows[1]]) - bark
    return Limb(
        number=number,
        name=name,
        label=branch.label,
        rows=rows,
        xyz=xyz,
        along=along,
        parent=parent,
        bark=bark,
        reach=reach,
    )


def _farthest(skeleton: Skeleton, lengths: Floats) -> Floats:
    """The longest way (M,) from each row to a tip, metres."""
    far = np.zeros(len(skeleton))
    for row in range(len(skeleton) - 1, 0, -1):
        parent = skeleton.parent[row]
        far[parent] = max(far[parent], far[row] + lengths[row])
    return far
