"""The axes of branches as one view sees them: thin, comparable between views, with their doubt.

A view sees the near side of a branch, and stereo smears it: a ribbon, wider than the branch, whose
middle line is right across the view and too near by about the branch's radius. Views from other
places err to other sides, so the points are first drawn together to that line and then pushed away
from the camera by the radius, which the width of the ribbon tells.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from prunus.fusion.axes import contract
from prunus.fusion.views import Seen
from prunus.geometry.near import within
from prunus.geometry.neighbours import cover
from prunus.geometry.vectors import unit
from prunus.model import Floats, Ints

THIN = 0.004
"""Points are first thinned to balls of this radius, metres."""
AROUND = 0.025
"""Points so near, metres, decide which line a point goes to."""
ROUNDS = 5
"""How often points are drawn together."""
LINE = 0.95
"""Least share by which the surroundings of a sample are a line (see `fusion.axes.main_axis`)."""
ASIDE = 0.3
"""The middle of its surroundings is so far along the line from a sample, at most, in `AROUND`."""
SPACING = 0.015
"""One sample is kept in each cube of this side, metres."""
BESIDE = 0.02
"""The width is that of the points drawn to within so many metres of a sample."""
FEWEST = 5
"""Samples with fewer such points are dropped."""
DEEPER = (0.72, -0.24, 0.42)
"""How far the axis lies behind the middle of its ribbon: shares of half the ribbon's width, of a
pixel's width, and of what a pixel's width gains in depth along the branch; and `DEEPER_BY`."""
DEEPER_BY = 0.0022
"""Metres to be added. Fitted to simulated scans (`docs/fuse.md`), as are the errors below."""
HEAD_ON = 0.95
"""Cosine between branch and line of sight over which a branch is seen head on, and dropped."""
ACROSS_ERR = (0.0007, 0.05, 0.015)
"""Standard deviation of a sample across the view: metres, shares of half the ribbon's width, and
metres for surroundings that are no line at all."""
DEPTH_ERR = (0.0021, 0.0015, 0.15)
"""Standard deviations of its depth: metres at 1 m, growing as z^2; metres; shares of that width."""
CLOUD_ERR = 0.004
"""Standard deviation of a sample of a partial cloud, metres, any direction."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Threads:
    """S samples of branch axes in the view's frame: xyz (S, 3), axis (S, 3), doubt (S, 3, 3).

    The axis is a unit vector of either sign; the doubt a covariance, square metres. `held` (3,) is
    the place whose shift counts as that of the view: the camera, or the middle of a partial cloud.
    """

    xyz: Floats
    axis: Floats
    doubt: Floats
    held: Floats

    def __len__(self) -> int:
        return len(self.xyz)


def threads_of(seen: Seen, rng: np.random.Generator) -> Threads:
    """The samples of a view's branch axes; there may be none."""
    surface, size = cover(seen.xyz, rng.permutation(len(seen.xyz)), THIN)
    drawn, axis, line, aside, _ = contract(surface, np.sqrt(size.astype(float)), AROUND, ROUNDS)
    rows = _spaced(drawn, np.flatnonzero((line >= LINE) & (aside <= ASIDE)))
    start, near = within(drawn, drawn[rows], BESIDE)
    kept = np.diff(start) >= FEWEST
    if seen.pixel == 0:
        middle = seen.xyz.mean(axis=0) if len(seen.xyz) else np.zeros(3)
        doubt = np.broadcast_to(CLOUD_ERR**2 * np.eye(3), (int(kept.sum()), 3, 3))
        return Threads(
            xyz=drawn[rows[kept]],
            axis=axis[rows[kept]],
            doubt=np.ascontiguousarray(doubt),
            held=middle,
        )
    ray = unit(surface)
    wide = _half_width(surface - drawn, axis, ray, start, near)
    xyz, axis, ray, line = drawn[rows], axis[rows], ray[rows], line[rows]
    xyz = xyz + _to_axis(xyz, axis, ray, wide, seen.pixel)
    kept &= np.abs((axis * ray).sum(axis=1)) <= HEAD_ON
    return Threads(
        xyz=xyz[kept], axis=axis[kept], doubt=_doubt(xyz, ray, wide, line)[kept], held=np.zeros(3)
    )


def _half_width(off: Floats, axis: Floats, ray: Floats, start: Ints, near: Ints) -> Floats:
    """Half the width (N,) of the ribbons of some samples, from the points drawn near to each.

    The points (P,) were drawn by `off` (P, 3). A ribbon evenly filled from -h to h has the mean
    square h^2 / 3.
    """
    side = unit(np.cross(axis, ray))
    square = (off * side).sum(axis=1) ** 2
    total = np.concatenate([[0.0], square[near].cumsum()])
    return np.asarray(np.sqrt(3 * np.diff(total[start]) / np.maximum(np.diff(start), 1)))


def _to_axis(xyz: Floats, axis: Floats, ray: Floats, wide: Floats, pixel: float) -> Floats:
    """From the middles of ribbons to the axes of their branches (N, 3).

    That is the radius, which grows with the width. And where a branch leads away from the camera,
    each pixel has the depth of what is nearest of all that spills into it, which is nearer.
    """
    width = pixel * xyz[:, 2]
    sine = np.minimum(np.abs((axis * ray).sum(axis=1)), HEAD_ON)
    gained = width * sine / np.sqrt(1 - sine**2)
    deeper = np.column_stack([wide, width, gained]) @ DEEPER + DEEPER_BY
    return np.asarray(np.maximum(deeper, 0.0)[:, None] * ray)


def _doubt(xyz: Floats, ray: Floats, wide: Floats, line: Floats) -> Floats:
    """Covariances (N, 3, 3) of samples: good across the view, worse along it."""
    across = ACROSS_ERR[0] + ACROSS_ERR[1] * wide + ACROSS_ERR[2] * (1 - line)
    along = np.hypot(DEPTH_ERR[0] * xyz[:, 2] ** 2, DEPTH_ERR[1] + DEPTH_ERR[2] * wide)
    both = ray[:, :, None] * ray[:, None, :]
    return np.asarray((across**2)[:, None, None] * np.eye(3) + (along**2)[:, None, None] * both)


def _spaced(xyz: Floats, rows: Ints) -> Ints:
    """One of the rows of xyz (P, 3) in each cube of side `SPACING`."""
    cells = np.floor(xyz[rows] / SPACING).astype(np.int64)
    return np.asarray(rows[np.unique(cells, axis=0, return_index=True)[1]])
