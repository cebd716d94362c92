"""One branch of a refined tree, measured."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from prunus.geometry.exits import exit_along
from prunus.model import Floats, Label
from prunus.model.branches import Branch
from prunus.refine.radii import USUAL, Unknown, known_radius
from prunus.refine.refined import Refined

Record = dict[str, Any]
"""Traits by name."""

DIRECTION = 0.10
"""The direction of a branch at its foot is that of its first so many metres."""
ABOVE = 0.30
"""A diameter is told so far along each branch, metres: of a leader, above the support."""


@dataclass(frozen=True, eq=False)
class Limb:
    """One branch of a refined tree (R nodes, the first on its parent's axis), and its parent."""

    tree: Refined
    branch: Branch
    parent: Branch | None

    @cached_property
    def line(self) -> Floats:
        """Its nodes (R, 3)."""
        return self.tree.skeleton.xyz[self.branch.rows]

    @cached_property
    def way(self) -> Floats:
        """Metres (R,) along it."""
        steps = self.tree.skeleton.lengths[self.branch.rows[1:]]
        return np.concatenate([[0.0], steps.cumsum()])

    @cached_property
    def inner(self) -> float:
        """Metres of it within the wood of its parent."""
        if self.parent is None:
            return 0.0
        tree = self.tree.skeleton
        radius = known_radius(tree, int(self.branch.rows[0]), self.parent.label)
        return exit_along(self.line, self.way, tree.xyz[self.parent.rows], radius)

    def at(self, along: float, values: Floats) -> float:
        """The value of (M,) at so many metres along it; at its foot its own, not its parent's."""
        if along > self.way[-1]:
            return math.nan
        rows = self.branch.rows
        return float(np.interp(along, self.way[1:], values[rows[1:]]))

    def sizes(self) -> Record:
        """Lengths and heights, metres."""
        low = self.tree.skeleton.xyz[0, 2]
        foot = math.nan
        if self.parent is not None:
            before = self.parent.rows[: int((self.parent.rows == self.branch.rows[0]).argmax()) + 1]
            foot = float(self.tree.skeleton.lengths[before[1:]].sum())
        return {
            "path_length_m": float(self.way[-1]),
            "length_m": float(np.linalg.norm(self.line[-1] - self.line[0])),
            "foot_height_m": float(self.line[0, 2] - low),
            "height_m": float(self.line[:, 2].max() - low),
            "foot_at_m": foot,
        }

    def diameters(self) -> Record:
        """Diameters and their standard deviations, millimetres."""
        places = {"base": self.inner, "middle": self.way[-1] / 2, "30cm": ABOVE}
        told: Record = {}
        for name, along in places.items():
            told[f"diameter_{name}_mm"] = 2e3 * self.at(along, self.tree.skeleton.radius)
            told[f"diameter_{name}_error_mm"] = 2e3 * self.at(along, self.tree.radius_error)
        return told

    def directions(self) -> Record:
        """Angles, degrees."""
        x, y, z = (self.line[-1] - self.line[0]).tolist()
        return {
            "angle_deg": self._angle(),
            "azimuth_deg": math.degrees(math.atan2(y, x)) % 360,
            "lean_deg": math.degrees(math.atan2(math.hypot(x, y), z)),
        }

    def _angle(self) -> float:
        if self.parent is None:
            return math.nan
        line, rows = self.tree.skeleton.xyz[self.parent.rows], self.parent.rows
        at = int((rows == self.branch.rows[0]).argmax())
        on = line[min(at + 2, len(line) - 1)] - line[max(at - 2, 0)]
        end = min(DIRECTION, float(self.way[-1]))
        own = np.array([np.interp(end, self.way, self.line[:, a]) for a in range(3)]) - self.line[0]
        size = float(np.linalg.norm(on) * np.linalg.norm(own))
        return math.degrees(math.acos(np.clip(on @ own / size, -1, 1))) if size > 0 else math.nan

    def wood(self) -> Record:
        """Volume, surface and cross-section; NaN where a radius is unknown."""
        radius = self.tree.skeleton.radius[self.branch.rows]
        radius = np.concatenate([radius[1:2], radius[1:]])
        first, second = radius[:-1], radius[1:]
        step = np.diff(np.maximum(self.way, self.inner))
        volume = math.pi / 3 * (step * (first**2 + first * second + second**2)).sum()
        surface = math.pi * ((first + second) * np.hypot(step, first - second) * (step > 0)).sum()
        base = self.at(self.inner, self.tree.skeleton.radius)
        return {
            "volume_cm3": 1e6 * float(volume),
            "surface_cm2": 1e4 * float(surface),
            "cross_section_cm2": 1e4 * math.pi * base**2,
        }

    def evidence(self) -> Record:
        """What of it the scan shows, and why a diameter is unknown."""
        rows = self.branch.rows[1:]
        why = [Unknown(value).words for value in np.unique(self.tree.unknown[rows])]
        error = self.at(self.inner, self.tree.radius_error)
        return {
            "seen_share": self.tree.seen_share(rows),
            "diameter_told_share": _told(self.branch.label, error),
            "diameter_missing": "; ".join(word for word in why if word),
        }


def _told(label: Label, error: float) -> float:
    """Share of the doubt (variance) about a radius that its measured error has taken away."""
    usual = USUAL[label][1]
    return float(np.clip(1 - (error / usual) ** 2, 0.0, 1.0))
