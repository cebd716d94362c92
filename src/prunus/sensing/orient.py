"""Which named frame a cloud is in, by the evidence in the cloud.

Leaders are most of the wood, and they stand up. So the axis along which the local pieces of wood
run is the vertical one: Z in a `z-up` cloud, Y in an `optical` one. (X is along the row in both.)
"""

from __future__ import annotations

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


def find_frame(xyz: Floats) -> tuple[str, str]:
    """The name of the frame, and a line that says why.

    Clouds without a decision are taken as `z-up`, and the line begins with `undecided`.
    """
    _, along_y, along_z = wood_along_axes(xyz - xyz[0])
    if along_y > NEEDED * along_z:
        return "optical", f"most wood runs along Y ({along_y:.0%}), little along Z ({along_z:.0%})"
    if along_z > NEEDED * along_y:
        return "z-up", f"most wood runs along Z ({along_z:.0%}), little along Y ({along_y:.0%})"
    return "z-up", (
        f"undecided: wood runs along Y ({along_y:.0%}) and Z ({along_z:.0%}) alike; "
        "say --frame optical if Y points down"
    )


def wood_along_axes(points: Floats) -> Floats:
    """Share (3,) of the local linear structure that runs along each axis."""
    linear, directions = local_wood(points)
    along = (linear[:, None] * directions**2).sum(axis=0)
    return np.asarray(along / max(along.sum(), 1e-12))


def local_wood(points: Floats) -> tuple[Floats, Floats]:
    """How much `PATCHES` local pieces of wood are lines (C,), 0 to 1, and their directions (C, 3).

    Of at most `LOOKED_AT` points.
    """
    points = points[:: max(1, len(points) // LOOKED_AT)]
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
    return np.asarray(linear), np.asarray(directions[:, :, 2])
