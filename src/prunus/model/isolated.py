"""What each point of a raw scan is to one tree."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from prunus.model import Bools, Floats, Ints, Kind


@dataclass(frozen=True, eq=False)
class Isolated:
    """What each point (P,) of a scan is to one tree (`model.Kind`), and where that stands.

    `foot` (3,), house frame: the lowest point of the trunk that the scan holds.
    """

    kind: Ints
    foot: Floats

    @property
    def target(self) -> Bools:
        """The points (P,) of the tree."""
        return np.asarray(self.kind == Kind.TARGET)

    @property
    def removed(self) -> float:
        """The share of the points, strays apart, that are not the tree."""
        counted = self.kind != Kind.STRAY
        return float(1 - self.target.sum() / max(counted.sum(), 1))

    def told(self) -> str:
        """What was taken out, in a line."""
        counts = np.bincount(self.kind, minlength=len(Kind))
        others = sorted((kind for kind in Kind if counts[kind]), key=lambda kind: -counts[kind])
        parts = [f"{kind.name.lower()} {counts[kind] / len(self.kind):.1%}" for kind in others
                 if kind != Kind.TARGET]  # fmt: skip
        return (
            f"a raw scan: {counts[Kind.TARGET]} of {len(self.kind)} points are the tree; "
            f"left out: {', '.join(parts)}"
        )
