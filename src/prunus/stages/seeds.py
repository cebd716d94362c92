"""Where the skeleton starts and where it grows to (sec. Tip and trunk identification)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from prunus.errors import PrunusError
from prunus.kernels.angles import grow_angle
from prunus.kernels.forest import components, spanning_forest
from prunus.model import Bools, Floats, Ints, ScoredGraph, SeededGraph
from prunus.params import Parameters

STEEP = np.pi / 4
"""Forest edges with a smaller GrowAngle are horizontal, and hold no tip."""

BASE_REACH = 2.0
"""A base given by hand lies within this many r_super of a superpoint."""


def find_seeds(
    scored: ScoredGraph, params: Parameters, base: ArrayLike | None = None
) -> tuple[SeededGraph, list[str]]:
    """The base and the tips, with warnings in plain words.

    `base` (3,) is a point of the house frame picked by hand; None finds one. Raises PrunusError
    where the base is far from every superpoint, or no tip is found.
    """
    warnings: list[str] = []
    if base is None:
        root = lowest_of_largest(scored, params.confidence.alpha_conf)
        warnings.append(
            "no base was given: the lowest superpoint of the largest connected piece was taken"
        )
    else:
        root = nearest_superpoint(scored, np.asarray(base, np.float64))
    tips = find_tips(scored.xyz, scored.edges, scored.confidence, params)
    tips = tips[tips != root]
    if len(tips) == 0:
        raise PrunusError(
            "no tips of leaders were found: no upright edge of confidence "
            f"{params.confidence.alpha_conf:g} in the upper {params.tips.alpha_tip:.0%} of the "
            f"tree, {np.ptp(scored.xyz[:, 2]):.3g} m from its lowest to its highest superpoint; "
            "expected an orchard tree of some metres, standing (see the frame and the unit)"
        )
    return SeededGraph(scored, root, tips), warnings


def find_tips(xyz: Floats, edges: Ints, confidence: Floats, params: Parameters) -> Ints:
    """Tips (T,): the highest node of each upright piece of the spanning forest near the top."""
    sure = confidence >= params.confidence.alpha_conf
    edges, confidence = edges[sure], confidence[sure]
    vector = xyz[edges[:, 1]] - xyz[edges[:, 0]]
    weight = np.linalg.norm(vector, axis=1) * (1 - confidence)
    forest = spanning_forest(len(xyz), edges, np.argsort(weight, kind="stable"))
    z = xyz[:, 2]
    floor = z.max() - params.tips.alpha_tip * (z.max() - z.min())
    upright = grow_angle(vector) >= STEEP
    high = (z[edges] >= floor).all(axis=1)
    kept = edges[forest & upright & high]
    piece = components(len(xyz), kept)
    held: Bools = np.isin(np.arange(len(xyz)), kept)
    nodes = np.flatnonzero(held)
    ordered = nodes[np.lexsort([nodes, -z[nodes], piece[nodes]])]
    first = np.unique(piece[ordered], return_index=True)[1]
    return np.sort(ordered[first])


def nearest_superpoint(scored: ScoredGraph, point: Floats) -> int:
    """The superpoint nearest to a base picked by hand, one with an edge where there is one."""
    distance = np.linalg.norm(scored.xyz - point, axis=1)
    reach = BASE_REACH * scored.candidates.superpoints.radius
    if distance.min() > reach:
        cloud = scored.candidates.superpoints.cloud
        near = cloud.to_input.apply(scored.xyz[distance.argmin()])
        raise PrunusError(
            f"the base {_shown(cloud.to_input.apply(point))} is {distance.min():.2f} m from the "
            f"nearest part of the tree, {_shown(near)}; expected at most {reach:.2f} m "
            "(the base is in the frame and unit of the input file)"
        )
    joined = np.isin(np.arange(len(distance)), scored.edges) & (distance <= reach)
    return int(np.where(joined, distance, distance + reach).argmin())


def near_to(scored: ScoredGraph, point: Floats) -> bool:
    """Whether a base picked by hand is near any superpoint."""
    distance = np.linalg.norm(scored.xyz - point, axis=1)
    return bool(distance.min() <= BASE_REACH * scored.candidates.superpoints.radius)


def lowest_of_largest(scored: ScoredGraph, alpha_conf: float) -> int:
    """The lowest superpoint of the largest piece joined by confident edges."""
    piece = components(len(scored.xyz), scored.edges[scored.confidence >= alpha_conf])
    largest = np.bincount(piece).argmax()
    nodes = np.flatnonzero(piece == largest)
    return int(nodes[scored.xyz[nodes, 2].argmin()])


def _shown(point: Floats) -> str:
    return "(" + ", ".join(f"{value:.2f}" for value in point) + ")"
