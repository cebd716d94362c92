"""Why no tree was found in a cloud, by the evidence in it, and what to try."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np

from prunus.errors import NoTreeError
from prunus.frames.orient import Up, local_wood
from prunus.frames.patches import Cells
from prunus.frames.stance import seems
from prunus.geometry.near import within
from prunus.model import FRAMES, Floats, PointCloud
from prunus.model.steps import step_of

MAX_POINTS = 20_000
"""Larger clouds are thinned to so many points before they are looked at."""
ONE_PLACE_M = 1e-3
"""Points no farther apart are in one place."""
SMALL_M, LARGE_M = 0.30, 12.0
"""A tree of an orchard is larger, and smaller."""
LINE_M, PLANE_M = 0.002, 0.010
"""Points on a line, and in a plane, are so near to it (root mean square). No scan of a tree was
nearer than 0.15 and 0.04 m (`python -m bench.plausible`)."""
STEP_M = 0.02
"""Coordinates in such steps hardly show a branch, which is seldom thicker."""
SPARSE_M = 0.02
"""Points so far from each other cannot either."""
PLACES = 200
"""At so many points it is looked how far the next is."""
UPRIGHT = 0.7
"""Two upward directions are alike where their cosine is over this."""
LINEAR = 0.35
"""Local wood is a line by so much, on average: 0.41 at least on 94 simulated scans of trees, 0.28
at most on noise, hedges and cones of needles (`python -m bench.plausible`)."""

TRY = "expected one dormant tree, standing, Z up, in metres: see --frame, --unit, --base"


@contextmanager
def explaining(cloud: PointCloud) -> Iterator[None]:
    """Where no tree is found in here, say why, by the cloud that was given."""
    try:
        yield
    except NoTreeError as error:
        raise NoTreeError(f"{error}; {why_no_tree(cloud)}") from error


def why_no_tree(cloud: PointCloud) -> str:
    """What is wrong with a cloud in which no tree was found, and what to try."""
    xyz = _some(cloud)
    return next((why for look in LOOKS if (why := look(cloud, xyz))), TRY)


def _some(cloud: PointCloud) -> Floats:
    return cloud.xyz[:: max(1, len(cloud) // MAX_POINTS)]


def _small(cloud: PointCloud, xyz: Floats) -> str:
    size = _size(xyz)
    if size.max() < ONE_PLACE_M:
        return "all points lie in one place"
    if size.max() < SMALL_M:
        return f"the cloud measures {_metres(size)}, too little: is the unit right (--unit)?"
    return ""


def _flat(cloud: PointCloud, xyz: Floats) -> str:
    off_plane, off_line, _ = spread(xyz)
    if off_line < LINE_M:
        return "all points lie on one line"
    flat = off_plane < PLANE_M < 0.2 * off_line
    return "all points lie in one plane" if flat else ""


def _coarse(cloud: PointCloud, xyz: Floats) -> str:
    step = coarseness(cloud)
    return coarse_words(step) if step >= STEP_M else ""


def _sparse(cloud: PointCloud, xyz: Floats) -> str:
    apart = spacing(cloud.xyz)
    if apart < SPARSE_M:
        return ""
    return (
        f"neighbouring points are about {apart:.2g} m apart in a cloud of {_metres(_size(xyz))}; "
        "expected about 1 cm: a denser cloud, or another unit (--unit)?"
    )


def _large(cloud: PointCloud, xyz: Floats) -> str:
    size = _size(xyz)
    if size.max() < LARGE_M:
        return ""
    return f"the cloud measures {_metres(size)}: is the unit right (--unit)? {TRY}"


def frame_by_evidence(cloud: PointCloud) -> str:
    """The frame in which another axis than Z is up, by all evidence in a cloud; nothing if none."""
    up = seems(cloud.to_input.apply(_some(cloud)))
    return "" if up.others or _upward(cloud, up) else up.frame


def _lying(cloud: PointCloud, xyz: Floats) -> str:
    """In the frame of the file, whose name is what can be said otherwise."""
    up = seems(cloud.to_input.apply(xyz))
    if _upward(cloud, up):
        return ""
    return f"it seems to lie on its side, as {up.why}: try --frame {up.frame}"


def _upward(cloud: PointCloud, up: Up) -> bool:
    return bool(cloud.to_input.rotation[:, 2] @ FRAMES[up.frame][2] > UPRIGHT)


def _no_branches(cloud: PointCloud, xyz: Floats) -> str:
    if linear_wood(xyz) > LINEAR:
        return ""
    return f"hardly anything in it is like a branch: {TRY}"


LOOKS: tuple[Callable[[PointCloud, Floats], str], ...] = (
    _small, _flat, _coarse, _sparse, _large, _lying, _no_branches,
)  # fmt: skip
"""What is looked for, in this order: a sentence, or nothing."""


def coarseness(cloud: PointCloud) -> float:
    """The largest steps in which coordinates of a cloud come, metres; 0 where they come in none.

    In the frame of the file: steps of levelled coordinates are none.
    """
    return max(step_of(values)[0] for values in cloud.to_input.apply(cloud.xyz).T)


def coarse_words(step: float) -> str:
    """What such steps mean."""
    return (
        f"the coordinates come in steps of {step:.3g} m: single precision, or rounded? Expected "
        "double precision, or coordinates near the origin"
    )


def spread(xyz: Floats) -> Floats:
    """How far points (P, 3) spread along their axes (3,), the least first: root mean squares."""
    away = xyz - xyz.mean(axis=0)
    return np.asarray(np.sqrt(np.linalg.eigvalsh(away.T @ away / len(xyz)).clip(0)))


def linear_wood(xyz: Floats) -> float:
    """How much the mean piece of wood in points (P, 3) is a line, 0 to 1; 0 where all is flat."""
    linear = local_wood(Cells.of(xyz)).linear
    return float(linear.mean()) if len(linear) else 0.0


def spacing(xyz: Floats) -> float:
    """About how far the next point is from most points (P, 3), to a factor of 1.4, metres."""
    places = xyz[:: max(1, len(xyz) // PLACES)]
    radius = 0.005
    while radius < LARGE_M:
        start, _ = within(xyz, places, radius)
        if np.median(np.diff(start)) > 1:
            break
        radius *= np.sqrt(2)
    return float(radius)


def _size(xyz: Floats) -> Floats:
    """Width, depth and height (3,) of almost all points (P, 3)."""
    low, high = np.quantile(xyz, [0.005, 0.995], axis=0)
    return np.asarray(high - low)


def _metres(size: Floats) -> str:
    return " x ".join(f"{length:.3g}" for length in size) + " m"
