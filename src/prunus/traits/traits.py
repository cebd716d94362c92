"""Traits of a tree and of its branches, for breeders and growers: a row a branch, a row a tree.

`measure.defined` says what each is. What cannot be told is NaN: a diameter where the
refined skeleton has no radius.
"""

from __future__ import annotations

import math

import numpy as np

from prunus.model import Label, Skeleton
from prunus.model.branches import branch_of_rows, branches, orders
from prunus.model.leaders import leaders
from prunus.refine.refined import Refined
from prunus.traits.definitions import BRANCH_TRAITS, TREE_TRAITS, ZONES
from prunus.traits.sizes import Limb, Record
from prunus.trust import Trust


def branch_traits(tree: Refined, trust: Trust | None = None) -> list[Record]:
    """The traits of each branch (see `BRANCH_TRAITS`); without `trust` that is NaN."""
    skeleton = tree.skeleton
    found = branches(skeleton)
    names, order = tree.names, orders(found, len(skeleton))
    owner = branch_of_rows(found, len(skeleton))
    spacing = {leader.row: leader.spacing for leader in leaders(skeleton)}
    carried = [int(owner[b.rows[0]]) for b in found if b.label == Label.SIDE_BRANCH]
    records = []
    for number, branch in enumerate(found):
        above = int(owner[branch.rows[0]])
        limb = Limb(tree, branch, found[above] if above >= 0 else None)
        records.append(
            {
                "branch": number, "name": names[number], "label": branch.label.word,
                "parent": above if above >= 0 else None, "order": int(order[number]),
                "zone": _zone(skeleton, limb.line[0, 2]), **limb.sizes(), **limb.diameters(),
                **limb.directions(), "spacing_m": spacing.get(int(branch.rows[-1]), math.nan),
                "side_branches": carried.count(number), **limb.wood(), **limb.evidence(),
                "trust": math.nan if trust is None else float(trust.branch[number]),
            }
        )  # fmt: skip
    return [{name: record[name] for name in BRANCH_TRAITS} for record in records]


def _zone(skeleton: Skeleton, height: float) -> str:
    low, high = skeleton.xyz[0, 2], float(skeleton.xyz[:, 2].max())
    third = int(3 * (height - low) / max(high - low, 1e-9))
    return ZONES[min(max(third, 0), 2)]


def tree_traits(tree: Refined, trust: Trust | None = None) -> Record:
    """The traits of the whole tree (see `TREE_TRAITS`); without `trust` that is NaN."""
    rows, skeleton = branch_traits(tree), tree.skeleton
    of = {label: [row for row in rows if row["label"] == label.word] for label in Label}
    sides = of[Label.SIDE_BRANCH]
    lead = {row["branch"] for row in of[Label.LEADER]}
    on_leaders = sum(row["parent"] in lead for row in sides)
    lengths, extent = skeleton.lengths, np.ptp(skeleton.xyz, axis=0)
    total = max(float(lengths.sum()), 1e-9)
    record: Record = {
        "height_m": float(skeleton.xyz[:, 2].max() - skeleton.xyz[0, 2]),
        "width_m": float(extent[0]),
        "depth_m": float(extent[1]),
        "supports": len(of[Label.SUPPORT]),
        "leaders": len(lead),
        "side_branches": len(sides),
        "side_branches_per_leader": on_leaders / len(lead) if lead else math.nan,
        "leader_spacing_m": _mean(of[Label.LEADER], "spacing_m"),
        "leader_height_m": _mean(of[Label.LEADER], "height_m"),
        "leader_lean_deg": _mean(of[Label.LEADER], "lean_deg"),
        "trunk_cross_section_cm2": _trunk_section(of[Label.TRUNK]),
        "leader_cross_section_cm2": sum(row["cross_section_cm2"] for row in of[Label.LEADER]),
        "diameters_known_share": float(lengths[np.isfinite(skeleton.radius)].sum()) / total,
        "seen_share": float(lengths[tree.seen].sum()) / total,
        "trust": math.nan if trust is None else trust.tree,
    }
    for zone in ZONES:
        record[f"side_branches_{zone}"] = sum(row["zone"] == zone for row in sides)
    for label in Label:
        record[f"{label.word}_length_m"] = sum((row["path_length_m"] for row in of[label]), 0.0)
    for name in ("volume_cm3", "surface_cm2"):
        record[name] = float(np.nansum([row[name] for row in rows]))
    return {name: record[name] for name in TREE_TRAITS}


def _mean(rows: list[Record], name: str) -> float:
    values = [row[name] for row in rows if not math.isnan(row[name])]
    return float(np.mean(values)) if values else math.nan


def _trunk_section(trunks: list[Record]) -> float:
    if not trunks:
        return math.nan
    high = trunks[0]["diameter_30cm_mm"]
    across = trunks[0]["diameter_middle_mm"] if math.isnan(high) else high
    return float(math.pi / 4 * (across / 10) ** 2)
