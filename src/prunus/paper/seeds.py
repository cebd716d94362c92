"""Where the skeleton starts and where it grows to (sec. Tip and trunk identification)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from prunus.errors import NoTreeError, PrunusError
from prunus.geometry.pieces import components
from prunus.model import FRAMES, Bools, Floats, Ints, Label, ScoredGraph, SeededGraph
from prunus.paper.kernels.angles import grow_angle
from prunus.paper.kernels.forest import spanning_forest
from prunus.params import Parameters

STEEP = np.pi / 4
"""Forest edges with a smaller GrowAngle are horizontal, and hold no tip."""

BASE_REACH = 2.0
"""A base given by hand lies within this many r_super of a superpoint."""
WEEDS_M = 0.50
"""Or straight below the foot of a trunk, which weeds may hide for so many metres."""
SURE = 0.30
"""Edges of this confidence are wood."""
FOOT_SHARE = 0.35
"""Wood at a foot is likely trunk, or the support that it bends into, by so much."""
ABOVE_M = 0.30
"""A base so far above the lowest wood of its tree is worth a remark, metres."""
MISTAKEN_M = 1.0
"""A base so far from the tree may have been given in another unit or frame, metres."""
UNITS = {"millimetres": 1e-3, "centimetres": 1e-2, "feet": 0.3048}
"""In which a base may have been given, in metres."""


def find_seeds(
    scored: ScoredGraph, params: Parameters, base: ArrayLike | None = None
) -> tuple[SeededGraph, list[str]]:
    """The base and the tips, with warnings in plain words.

    `base` (3,) is a point of the house frame picked by hand; None finds one. Raises PrunusError
    where the base is far from every superpoint, or no tip is found.
    """
    if base is None:
        root = lowest_of_largest(scored, params.confidence.alpha_conf)
        warnings = [
            "no base was given: the lowest superpoint of the largest connected piece was taken"
        ]
    else:
        root, warnings = nearest_superpoint(scored, np.asarray(base, np.float64)), []
    tips = find_tips(scored.xyz, scored.edges, scored.confidence, params)
    tips = tips[tips != root]
    if len(tips) == 0:
        raise NoTreeError(
            "no tips of leaders were found: no upright edge of confidence "
            f"{params.confidence.alpha_conf:g} in the upper {params.tips.alpha_tip:.0%} of the "
            "cloud"
        )
    return SeededGraph(scored, root, tips), [*warnings, *doubts_of_base(scored, root)]


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
        shown = scored.candidates.superpoints.cloud.words_for
        meant = _meant(scored, point) if distance.min() > MISTAKEN_M else ""
        raise PrunusError(
            f"the base {shown(point)} is {distance.min():.2f} m from the nearest part of "
            f"the tree, {shown(scored.xyz[distance.argmin()])}; expected at most "
            f"{reach:.2f} m (metres, in the frame of the file){meant}"
        )
    joined = np.isin(np.arange(len(distance)), scored.edges) & (distance <= reach)
    return int(np.where(joined, distance, distance + reach).argmin())


def out_of_weeds(scored: ScoredGraph, base: Floats | None) -> tuple[Floats | None, list[str]]:
    """A base (3,) picked by hand, if any, or the foot of the trunk above it, and a note on that.

    Weeds may hide the foot: the lowest wood in view is up to `WEEDS_M` above the ground then.
    """
    foot = None if base is None or near_to(scored, base) else foot_above(scored, base)
    if base is None or foot is None:
        return base, []
    shown = scored.candidates.superpoints.cloud.words_for(base)
    below = scored.xyz[foot, 2] - base[2]
    return scored.xyz[foot], [
        f"the base {shown} is {below:.2f} m below the lowest wood in view, which was taken"
    ]


def foot_above(scored: ScoredGraph, point: Floats) -> int | None:
    """The lowest superpoint that may be a foot, straight above a point (3,); None where none is."""
    away = scored.xyz - point
    reach = BASE_REACH * scored.candidates.superpoints.radius
    above = (np.linalg.norm(away[:, :2], axis=1) <= reach) & (away[:, 2] > 0)
    low = away[:, 2] <= WEEDS_M + scored.candidates.superpoints.radius
    found = np.flatnonzero(above & low & (thickness(scored) >= FOOT_SHARE))
    return int(found[away[found, 2].argmin()]) if len(found) else None


def thickness(scored: ScoredGraph) -> Floats:
    """How likely each superpoint (N,) is of trunk or support, by the sure edges that meet there.

    Of a scorer that tells no categories: 1 where there is a sure edge.
    """
    sure = scored.confidence >= SURE
    thick = np.ones(int(sure.sum()))
    if scored.category.size:
        thick = scored.category[sure][:, [Label.TRUNK, Label.SUPPORT]].sum(axis=1)
    most = np.zeros(len(scored.xyz))
    np.maximum.at(most, scored.edges[sure].T.ravel(), np.tile(thick, 2))
    return most


def doubts_of_base(scored: ScoredGraph, root: int) -> list[str]:
    """Why a base may be none: no thick wood is about it, or its tree goes on far below."""
    found = []
    xyz, shown = scored.xyz, scored.candidates.superpoints.cloud.words_for
    piece = components(len(xyz), scored.edges[scored.confidence >= SURE])
    own = np.flatnonzero(piece == piece[root])
    lowest = own[xyz[own, 2].argmin()]
    above = float(xyz[root, 2] - xyz[lowest, 2])
    if above > ABOVE_M:
        found.append(
            f"the base {shown(xyz[root])} is {above:.1f} m above the lowest wood of its "
            f"tree, {shown(xyz[lowest])}"
        )
    about = np.linalg.norm(xyz - xyz[root], axis=1)
    beside = about <= BASE_REACH * scored.candidates.superpoints.radius
    if thickness(scored)[beside].max() < FOOT_SHARE:
        found.append(f"the base {shown(xyz[root])} touches no trunk: thin wood is about it")
    return found


def _meant(scored: ScoredGraph, point: Floats) -> str:
    """The unit or frame in which a base that is far from the tree would be at it, in words.

    A tree that stands at the origin tells no unit: there any base is near it in millimetres.
    """
    to_file = scored.candidates.superpoints.cloud.to_input
    given = to_file.apply(point)
    units = {} if near_to(scored, to_file.inverse().apply(np.zeros(3))) else UNITS
    meant = {f"in {unit}": given * metres for unit, metres in units.items()}
    for name, to_house in FRAMES.items():
        meant[f"in the frame {name}"] = to_file.rotation @ to_house @ given
    away = {
        words: float(np.linalg.norm(scored.xyz - to_file.inverse().apply(place), axis=1).min())
        for words, place in meant.items()
    }
    best = min(away, key=lambda words: away[words])
    near = away[best] <= BASE_REACH * scored.candidates.superpoints.radius
    return f": is it given {best}?" if near else ""


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
