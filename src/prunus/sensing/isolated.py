"""What each point of a raw scan is to one tree."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from prunus.model import Bools, Floats, Ints, Kind

TORN = 0.35
"""So many superpoints torn off, for each of the tree, are many. Set by `python -m bench.plausible`:
of 29 simulated scans of which over 0.6 of the tree was kept one had 0.53, no other more than 0.24;
of 11 of which less was kept three had 0.44 to 1.6, the others 0.1 at most: of those this does not
tell."""


@dataclass(frozen=True, eq=False)
class Isolated:
    """What each point (P,) of a scan is to one tree (`model.Kind`), and where that stands.

    `base` (3,), house frame, is where the network looked from; `foot` (3,) the lowest point of the
    trunk that the scan holds; `rival` (3,) the foot of another tree that could be meant as well;
    `torn`: how many superpoints were left out that hang on the tree by sure edges, for each of it.
    """

    kind: Ints
    base: Floats
    foot: Floats
    rival: Floats | None = None
    torn: float = 0.0

    @property
    def target(self) -> Bools:
        """The points (P,) of the tree."""
        return np.asarray(self.kind == Kind.TARGET)

    @property
    def removed(self) -> float:
        """The share of the points, strays apart, that are not the tree."""
        counted = self.kind != Kind.STRAY
        return float(1 - self.target.sum() / max(counted.sum(), 1))

    def doubts(self) -> list[str]:
        """Why it may not be the tree, or not all of it."""
        if self.torn < TORN:
            return []
        return [
            f"{self.removed:.0%} of the scan was left out, though much of that hangs on the tree: "
            "is it all one tree (see --no-isolate)?"
        ]

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
