"""Which named frame a cloud is in, by the evidence in the cloud.

Leaders are most of the wood, and they stand up. So the axis along which the local pieces of wood
run is the vertical one: Z in a `z-up` cloud, Y in an `optical` one. (X is along the row in both.)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from prunus.kernels.neighbours import within
from prunus.model import Floats

PATCH = 0.10
"""Local pieces of wood are this large, metres."""
PATCHES = 400
"""How many pieces are looked at."""
LOOKED_AT = 20_000
"""Of so many points."""
NEEDED = 1.5
"""One axis must hold this many times as much wood as the other before the evidence counts."""


@dataclass(frozen=True, eq=False)
class Wood:
    """Local pieces of wood: how much each is a line (C,), 0 to 1, and its direction (C, 3)."""

    linear: Floats
    directions: Floats

    def turned(self, rotation: Floats) -> Wood:
        """The same wood in another frame."""
        return Wood(self.linear, self.directions @ rotation.T)

    def along_axes(self) -> Floats:
        """Share (3,) of the wood that runs along each axis."""
        along = (self.linear[:, None] * self.directions**2).sum(axis=0)
        return np.asarray(along / max(along.sum(), 1e-12))


def find_frame(wood: Wood) -> tuple[str, str]:
    """The name of the frame, and a line that says why.

    Clouds without a decision are taken as `z-up`, and the line begins with `undecided`.
    """
    _, along_y, along_z = wood.along_axes()
    if along_y > NEEDED * along_z:
        return "optical", f"most wood runs along Y ({along_y:.0%}), little along Z ({along_z:.0%})"
    if along_z > NEEDED * along_y:
        return "z-up", f"most wood runs along Z ({along_z:.0%}), little along Y ({along_y:.0%})"
    return "z-up", (
        f"undecided: wood runs along Y ({along_y:.0%}) and Z ({along_z:.0%}) alike; "
        "say --frame optical if Y points down"
    )


def local_wood(xyz: Floats) -> Wood:
    """The wood around `PATCHES` of at most `LOOKED_AT` of the points (P, 3)."""
    points = xyz[:: max(1, len(xyz) // LOOKED_AT)] - xyz[0]
    centers = points[:: max(1, len(points) // PATCHES)]
    start, members = within(points, centers, PATCH)
    sizes = np.diff(start)
    patch = np.repeat(np.arange(len(centers)), sizes)
    offsets = points[members] - centers[patch]
    moments = np.zeros((len(centers), 3, 3))
    mean = np.zeros((len(centers), 3))
    for i in range(3):
        mean[:, i] = np.bincount(patch, offsets[:, i], len(centers)) / sizes
        for j in range(3):
            products = offsets[:, i] * offsets[:, j]
            moments[:, i, j] = np.bincount(patch, products, len(centers)) / sizes
    spread, directions = np.linalg.eigh(moments - mean[:, :, None] * mean[:, None, :])
    linear = (spread[:, 2] - spread[:, 1]) / np.maximum(spread[:, 2], 1e-12)
    return Wood(np.asarray(linear), np.asarray(directions[:, :, 2]))
