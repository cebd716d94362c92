"""Radii along branches, from the widths of their ribbons and what is usual.

A branch tapers evenly from its foot to its tip. The width h of its ribbon follows from the radius r
and from the scan's noise n as h^2 = (r / WIDE)^2 + n^2: where the noise is greater than the
radius, a width tells little of it. So it is weighed against what is usual for such a branch; both
stand with their doubts, and so does the radius that comes out.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from prunus.model import Bools, Floats, Ints, Label, Skeleton
from prunus.refine.centrelines import STEP, Centrelines
from prunus.refine.ribbons import window

USUAL = {
    Label.TRUNK: (0.032, 0.0055, 0.026, 0.0055),
    Label.SUPPORT: (0.021, 0.0045, 0.015, 0.0040),
    Label.LEADER: (0.0135, 0.0040, 0.0065, 0.0025),
    Label.SIDE_BRANCH: (0.0050, 0.0020, 0.0030, 0.0012),
}
"""Usual radius at the foot and its standard deviation, and at the tip, metres.

Those of the simulated orchard (`docs/simulation.md`), and half as much doubt again.
"""


def known_radius(tree: Skeleton, row: int, label: Label) -> float:
    """The radius at a row of a tree, metres; half way along a usual branch where it is unknown."""
    foot, _, tip, _ = USUAL[label]
    radius = float(tree.radius[row])
    return radius if radius > 0 else (foot + tip) / 2


WIDE = 0.895
"""The radius is this share of half the width of a ribbon without noise."""
SHOWS = {
    Label.TRUNK: (0.3, 0.9),
    Label.SUPPORT: (1.2, 1.0),
    Label.LEADER: (1.45, 1.0),
    Label.SIDE_BRANCH: (1.08, 0.92),
}
"""How much of the noise a ribbon shows, at the foot and at the tip (fitted, see bench.refine)."""
ERR = (0.0005, 0.07, 0.30)
"""Standard deviation of half a width: metres, a share of the radius, a share of the noise."""
ERR_OF_ALL = (0.0003, 0.05, 0.20)
"""The same of an error that all half widths of a branch share."""
CORRELATION_M = 0.20
"""Half widths within this length of a branch err alike."""
UNEVEN = {
    Label.TRUNK: 0.06,
    Label.SUPPORT: 0.06,
    Label.LEADER: 0.045,
    Label.SIDE_BRANCH: 0.0,
}
"""No branch is as round and tapers as evenly as taken here: standard deviation, a share of the
radius, which is in the error alone (fitted, see bench.refine)."""
THIN_M = 0.010
"""Of branches usually thinner than this (radius) the noise is read off the widths."""
ROUNDS = 3
MIN_STATIONS = 3
"""A branch with fewer stations that have a width gets no radius."""
MAX_SCATTER = 4.0
"""A branch whose widths scatter by more, over their expected standard deviation, gets no radius."""
MAX_GAP_M = 0.15
"""A station farther along the branch from the next one that has a width gets no radius."""
MIN_RADIUS_M = 0.001
"""No radius is less."""


class Unknown(IntEnum):
    """Why a radius is unknown."""

    KNOWN = 0
    FEW_POINTS = 1
    RAGGED = 2
    FAR_FROM_POINTS = 3

    @property
    def words(self) -> str:
        """As a person reads it; nothing for a known radius."""
        return "" if self == Unknown.KNOWN else self.name.lower().replace("_", " ")


@dataclass(frozen=True, eq=False, kw_only=True)
class Tapers:
    """Radius and its standard deviation (S,), metres, at each station; `unknown` (S,), why not.

    `noise` is that of the whole scan, metres: what adds to half the width of a ribbon.
    """

    radius: Floats
    error: Floats
    unknown: Ints
    noise: float

    def part(self, stays: Bools) -> Tapers:
        """Those of these stations (S,) only."""
        return Tapers(
            radius=self.radius[stays],
            error=self.error[stays],
            unknown=self.unknown[stays],
            noise=self.noise,
        )


def tapers(lines: Centrelines, label: Ints, half: Floats) -> Tapers:
    """Radii along lines of some labels (B,), from half the widths (S,), NaN where there is none."""
    line, way = lines.line, lines.way()
    share = way / np.maximum(way[lines.last], STEP)[line]
    usual = np.array([USUAL[Label(number)] for number in label]).reshape(-1, 4)
    first = (1 - share) * usual[line, 0] + share * usual[line, 2]
    shows = np.array([SHOWS[Label(number)] for number in label]).reshape(-1, 2)
    shown = (1 - share) * shows[line, 0] + share * shows[line, 1]
    noise = _noise(half, first, shown)
    seen = np.isfinite(half)
    rows = np.flatnonzero(seen)
    fit = _Fit(
        line=line[rows], share=share[rows], half=half[rows], noise=noise * shown[rows], usual=usual
    )
    ends, doubt = fit.solved(len(label))
    mix = np.column_stack([1 - share, share])
    radius = np.maximum((mix * ends[line]).sum(axis=1), MIN_RADIUS_M)
    uneven = np.array([UNEVEN[Label(number)] for number in label])[line] * radius
    error = np.sqrt(np.einsum("si,sij,sj->s", mix, doubt[line], mix) + uneven**2)
    unknown = _unknown(lines, seen, fit.scatter(ends))
    return Tapers(radius=radius, error=error, unknown=unknown, noise=noise)


def _noise(half: Floats, usual: Floats, shown: Floats) -> float:
    """What adds to half a width where thin wood is as thick as usual."""
    thin = np.isfinite(half) & (usual < THIN_M)
    if not thin.any():
        return 0.0
    square = (half[thin] ** 2 - (usual[thin] / WIDE) ** 2) / shown[thin] ** 2
    return float(np.sqrt(max(np.median(square), 0.0)))


@dataclass(frozen=True, eq=False, kw_only=True)
class _Fit:
    """W half widths (W,) at shares (W,) of the way along lines (W,), in some noise."""

    line: Ints
    share: Floats
    half: Floats
    noise: Floats
    usual: Floats

    def modelled(self, ends: Floats) -> tuple[Floats, Floats]:
        """Half the widths (W,) for radii at feet and tips (B, 2), and their slopes (W,)."""
        mix = np.column_stack([1 - self.share, self.share])
        radius = np.maximum((mix * ends[self.line]).sum(axis=1), MIN_RADIUS_M)
        half = np.sqrt((radius / WIDE) ** 2 + self.noise**2)
        return half, radius / WIDE**2 / half

    def solved(self, lines: int) -> tuple[Floats, Floats]:
        """Radii (B, 2) at feet and tips, the tip no thicker, and their covariance (B, 2, 2).

        Least squares, weighed anew each round by how far off each width is (Cauchy's weights).
        """
        before = np.column_stack([self.usual[:, 0], self.usual[:, 2], np.zeros(lines)])
        shared = _norm(
            ERR_OF_ALL,
            self.usual[:, (0, 2)].mean(axis=1),
            float(self.noise.mean()) if len(self.noise) else 0.0,
        )
        trust = np.column_stack([self.usual[:, 1], self.usual[:, 3], shared]) ** -2.0
        found, doubt = before, np.asarray(np.zeros((lines, 3, 3)), np.float64)
        for _ in range(ROUNDS):
            half, slope = self.modelled(found[:, :2])
            rest = self.half - half - found[self.line, 2]
            design = np.column_stack([slope * (1 - self.share), slope * self.share, slope**0])
            weight = STEP / CORRELATION_M / self.err**2 / (1 + (rest / self.err / 3) ** 2)
            normal = trust[:, :, None] * np.eye(3) + self._summed(
                weight[:, None, None] * design[:, :, None] * design[:, None, :], lines
            )
            pull = (weight * rest)[:, None] * design
            right = trust * (before - found) + self._summed(pull, lines)
            doubt = np.asarray(np.linalg.inv(normal), np.float64)
            found = _tapering(found + (doubt @ right[:, :, None])[:, :, 0], doubt)
        return found[:, :2], doubt[:, :2, :2]

    @property
    def err(self) -> Floats:
        """Standard deviations (W,) of half the widths, metres."""
        usual = self.usual[self.line]
        radius = (1 - self.share) * usual[:, 0] + self.share * usual[:, 2]
        return _norm(ERR, radius, self.noise)

    def scatter(self, ends: Floats) -> Floats:
        """How far the widths of each line (B,) scatter, in units of `err`; NaN of too few."""
        rest = (self.half - self.modelled(ends)[0]) / self.err
        count, mean, square = (self._summed(rest**power, len(ends)) for power in (0, 1, 2))
        some = np.where(count < MIN_STATIONS, np.nan, count)
        return np.asarray(np.sqrt(np.maximum(square / some - (mean / some) ** 2, 0.0)))

    def _summed(self, values: Floats, lines: int) -> Floats:
        total = np.zeros((lines, *values.shape[1:]))
        np.add.at(total, self.line, values)
        return total


def _norm(err: tuple[float, float, float], radius: Floats, noise: Floats | float) -> Floats:
    """Standard deviations of three parts together: metres, of the radius, of the noise."""
    return np.asarray(np.sqrt(err[0] ** 2 + (err[1] * radius) ** 2 + (err[2] * noise) ** 2))


def _tapering(found: Floats, doubt: Floats) -> Floats:
    """Where a branch (B, 3) would be thicker at the tip, the likeliest that is not."""
    over = np.maximum(found[:, 1] - found[:, 0], 0.0)
    way = doubt[:, :, 1] - doubt[:, :, 0]
    return np.asarray(found - way * (over / (way[:, 1] - way[:, 0]))[:, None])


def _unknown(lines: Centrelines, seen: Bools, scatter: Floats) -> Ints:
    reach = round(MAX_GAP_M / STEP)
    near = window(lines, seen[:, None].astype(np.float64), reach)[:, 0] > 0
    unknown = np.where(near, Unknown.KNOWN, Unknown.FAR_FROM_POINTS)
    unknown[(scatter > MAX_SCATTER)[lines.line]] = Unknown.RAGGED
    unknown[np.isnan(scatter)[lines.line]] = Unknown.FEW_POINTS
    return unknown.astype(np.int64)
