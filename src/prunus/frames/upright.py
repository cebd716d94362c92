"""Which way up a tree stands: so that what grows on its votes is the surest.

The point field knows upright trees alone: of eight scans, each stood and laid five ways, the tree
was surer standing than lying, by 0.08 to 0.24, on all but one.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from prunus.errors import PrunusError
from prunus.growth.chain import Votes
from prunus.model import Floats, PointCloud, Skeleton
from prunus.params import Parameters

MAX_POINTS = 30_000
"""Larger clouds are thinned to so many points before a tree is looked for."""
MIN_SURER = 0.05
"""Another frame is taken where the tree is surer in it by at least this."""
TINY_M = 1e-9


def surest_frame(xyz: Floats, frames: Sequence[str]) -> str:
    """Of some frames that in which a tree in points (P, 3) of a file is surest.

    The first, where no other is better by `MIN_SURER`.
    """
    first, *others = frames
    best, least = first, sureness_in(xyz, first) + MIN_SURER if others else 0.0
    for frame in others:
        sure = sureness_in(xyz, frame)
        if sure > least:
            best, least = frame, sure
    return best


def sureness_in(xyz: Floats, frame: str) -> float:
    """How sure the tree in points (P, 3) of a file is in a frame; 0: there is none."""
    return sureness_of(PointCloud.from_xyz(xyz, frame))


def sureness_of(cloud: PointCloud) -> float:
    """How sure the tree that grows on the votes of a cloud is as it stands; 0: there is none."""
    params = Parameters().changed("input", points=MAX_POINTS)
    try:
        return sureness(Votes()(cloud, None, params, np.random.default_rng(0), {}).tree())
    except PrunusError:
        return 0.0


def sureness(skeleton: Skeleton) -> float:
    """The confidence of the edges of a skeleton in the mean over their length; 0: it has none."""
    if len(skeleton) == 1:
        return 0.0
    return float(np.average(skeleton.confidence[1:], weights=skeleton.lengths[1:] + TINY_M))
