"""A skeleton refined: its lines where the axes of the branches run, and their radii.

The skeleton of a graph goes from superpoint to superpoint, five to ten centimetres apart and in
front of the wood. Here it is fitted to all points of the tree. Labels and topology stay.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from prunus.model import Bools, Floats, Ints, PointCloud, Skeleton
from prunus.model.branch_names import branch_names
from prunus.model.branches import Branch, branches
from prunus.refine.centrelines import lines_of
from prunus.refine.fitting import Fit, fitted
from prunus.refine.radii import Unknown
from prunus.refine.ribbons import supported

TINY = 1e-9


@dataclass(frozen=True, eq=False, kw_only=True)
class Refined:
    """The refined skeleton in the house frame, and what is known of each of its nodes (M,).

    `skeleton` has a node about every centimetre; `superpoint` is kept at the node that stands for
    it, -1 elsewhere. `radius_error` is the standard deviation of the radius, metres; `unknown` why
    a radius is NaN (see `Unknown`); `seen` whether points of the scan lie at the node; `likely` how
    likely its branch is right, NaN where nobody knows. `named` are the names of the branches before
    they were refined, if they were.
    """

    skeleton: Skeleton
    radius_error: Floats
    unknown: Ints
    seen: Bools
    likely: Floats
    named: tuple[str, ...] = ()

    @property
    def names(self) -> list[str]:
        """The names of the branches: refining moves them, and would number them otherwise."""
        return list(self.named) or branch_names(self.skeleton, branches(self.skeleton))

    def seen_share(self, rows: Ints) -> float:
        """The share of the length of the edges into some rows that the scan has points of."""
        return float(np.average(self.seen[rows], weights=self.skeleton.lengths[rows] + TINY))

    @property
    def reason(self) -> list[str]:
        """Why each radius (M,) is NaN, in words; nothing where it is known."""
        return [Unknown(value).words for value in self.unknown]

    def radius_at(self, superpoints: Ints) -> Floats:
        """The radii (N,) at the nodes that stand for superpoints (N,); NaN where none does."""
        of = dict(
            zip(self.skeleton.superpoint.tolist(), self.skeleton.radius.tolist(), strict=True)
        )
        return np.array([of.get(node, np.nan) if node >= 0 else np.nan for node in superpoints])


def refined(skeleton: Skeleton, cloud: PointCloud, likely: Floats | None = None) -> Refined:
    """Refine a skeleton with the points of its tree, both in the house frame.

    The cameras are taken to stand at smaller Y. A stretch without points stays where it is.
    likely (M,): how likely the branch of each row is right.
    """
    likely = np.full(len(skeleton), np.nan) if likely is None else likely
    if len(skeleton) == 1:
        nothing = np.full(len(skeleton), int(Unknown.FEW_POINTS))
        unknown = np.full(len(skeleton), np.nan)
        return Refined(
            skeleton=skeleton.with_radius(unknown),
            radius_error=unknown,
            unknown=nothing,
            seen=nothing < 0,
            likely=likely,
        )
    lines, found = lines_of(skeleton)
    label = np.array([int(branch.label) for branch in found])
    least = np.array([len(branch.rows) for branch in found])
    fit = fitted(lines, label, least, cloud.xyz)
    return _assembled(skeleton, found, fit, likely)


def _assembled(skeleton: Skeleton, found: list[Branch], fit: Fit, likely: Floats) -> Refined:
    """One tree of the lines, each hung on the station of its parent at which it starts."""
    lines, taper = fit.lines, fit.tapers
    station = np.concatenate([[0], np.setdiff1d(np.arange(len(lines.xyz)), lines.first)])
    row = np.full(len(lines.xyz), -1)
    row[station] = np.arange(len(station))
    parent = row[np.maximum(station - 1, 0)]
    old = np.zeros(len(station), np.int64)
    stands = np.zeros(len(station), np.bool_)
    stands[0] = True
    for number, branch in enumerate(found):
        low, high = lines.start[number], lines.start[number + 1]
        parent[row[low + 1]] = 0 if lines.parent[number] < 0 else row[fit.foot[number]]
        place = _standing(lines.xyz[low + 1 : high], skeleton.xyz[branch.rows[1:]])
        old[row[low + 1 : high]] = branch.rows[1:][
            np.searchsorted(place, np.arange(high - low - 1)).clip(max=len(place) - 1)
        ]
        stands[row[low + 1 + place]] = True
    parent[0] = -1
    known = taper.unknown == Unknown.KNOWN
    radius, error = (
        np.where(known, values, np.nan)[station] for values in (taper.radius, taper.error)
    )
    tree = Skeleton(
        xyz=lines.xyz[station],
        parent=parent,
        label=skeleton.label[old],
        confidence=skeleton.confidence[old],
        radius=radius,
        superpoint=np.where(stands, skeleton.superpoint[old], -1),
    )
    seen, names = supported(lines, fit.count)[station], branch_names(skeleton, found)
    return Refined(
        skeleton=tree,
        radius_error=error,
        unknown=taper.unknown[station],
        seen=seen,
        likely=likely[old],
        named=tuple(names),
    )


def _standing(line: Floats, places: Floats) -> Ints:
    """The stations of a line (S, 3) that stand for some places (R, 3), R <= S, in their order."""
    square = ((line[:, None] - places[None]) ** 2).sum(axis=2)
    rank = np.arange(len(places))
    nearest = np.maximum.accumulate(square.argmin(axis=0) - rank)
    return np.asarray(np.minimum(nearest, len(line) - len(places)) + rank)
