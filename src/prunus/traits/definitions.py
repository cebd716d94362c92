"""What each trait is: names carry their units, and docs/measures.md shows the definitions."""

from __future__ import annotations

from dataclasses import dataclass

from prunus.model import Label

ZONES = ("lower", "middle", "upper")
"""Thirds of the height of a tree."""


@dataclass(frozen=True)
class Trait:
    """What a trait is: its unit, 1 for a share, - for none; its definition; how it is written."""

    unit: str
    definition: str
    kind: type = float


BRANCH_TRAITS: dict[str, Trait] = {
    "branch": Trait("-", "number of the branch, in the order in which they leave the tree", int),
    "name": Trait("-", "as in the report and the studio: leader 3 is the third from the left", str),
    "label": Trait("-", "trunk, support, leader or side_branch", str),
    "parent": Trait("-", "number of the branch that carries it; empty for the trunk", int),
    "order": Trait("-", "how many branches carry it, one on the other; 0 for the trunk", int),
    "zone": Trait("-", "the third of the tree's height in which it leaves its parent", str),
    "path_length_m": Trait("m", "along its line, from the axis of its parent to its tip"),
    "length_m": Trait("m", "straight from its foot to its tip"),
    "foot_height_m": Trait("m", "of its foot over the base of the tree"),
    "height_m": Trait("m", "of its highest point over the base of the tree"),
    "foot_at_m": Trait("m", "along its parent, from the parent's foot to where it leaves"),
    "diameter_base_mm": Trait("mm", "where it comes out of the wood of its parent"),
    "diameter_base_error_mm": Trait("mm", "standard deviation of that"),
    "diameter_middle_mm": Trait("mm", "half way along its line"),
    "diameter_middle_error_mm": Trait("mm", "standard deviation of that"),
    "diameter_30cm_mm": Trait("mm", "30 cm along its line, so of a leader 30 cm above the support"),
    "diameter_30cm_error_mm": Trait("mm", "standard deviation of that"),
    "angle_deg": Trait("degrees", "between its first 10 cm and the way its parent grows there"),
    "azimuth_deg": Trait(
        "degrees",
        "from foot to tip, seen from above: 0 to the right along the row, "
        "90 away from the cameras, 270 towards them",
    ),
    "lean_deg": Trait("degrees", "between the way from foot to tip and upright"),
    "spacing_m": Trait("m", "of a leader from the one before it, mean to mean along the row"),
    "side_branches": Trait("-", "side branches that leave it", int),
    "volume_cm3": Trait("cm3", "wood outside its parent, of cut cones from node to node"),
    "surface_cm2": Trait("cm2", "bark of the same"),
    "cross_section_cm2": Trait(
        "cm2", "limb cross-sectional area: a circle of its diameter at the base"
    ),
    "seen_share": Trait("1", "share of its path length at which the scan has points"),
    "diameter_told_share": Trait(
        "1",
        "share of the doubt about its diameter that the scan took away; "
        "0: the diameter is only what is usual",
    ),
    "trust": Trait("1", "probability that it is right: its label, and what it hangs on"),
    "diameter_missing": Trait(
        "-", "why its diameters are unknown; empty where they are known", str
    ),
}
"""Unit and definition of each trait of a branch."""

TREE_TRAITS: dict[str, Trait] = {
    "height_m": Trait("m", "of the highest point over the base"),
    "width_m": Trait("m", "from the leftmost to the rightmost point, along the row"),
    "depth_m": Trait("m", "from the nearest to the farthest point, across the row"),
    "supports": Trait("-", "how many", int),
    "leaders": Trait("-", "how many", int),
    "side_branches": Trait("-", "how many", int),
    **{
        f"side_branches_{zone}": Trait("-", f"in the {zone} third of the height", int)
        for zone in ZONES
    },
    "side_branches_per_leader": Trait("1", "of those that leave leaders, the mean number"),
    **{
        f"{label.word}_length_m": Trait(
            "m", f"path lengths of all {label.word.replace('_', ' ')} wood"
        )
        for label in Label
    },
    "leader_spacing_m": Trait("m", "mean spacing of neighbouring leaders along the row"),
    "leader_height_m": Trait("m", "mean height of the leaders' highest points"),
    "leader_lean_deg": Trait("degrees", "mean lean of the leaders"),
    "trunk_cross_section_cm2": Trait(
        "cm2", "of the trunk 30 cm along it, or half way along a shorter one"
    ),
    "leader_cross_section_cm2": Trait(
        "cm2", "limb cross-sectional areas of all leaders; unknown where one is"
    ),
    "volume_cm3": Trait("cm3", "wood of all branches whose diameters are known"),
    "surface_cm2": Trait("cm2", "bark of the same"),
    "diameters_known_share": Trait("1", "share of the path length whose diameter is known"),
    "seen_share": Trait("1", "share of the path length at which the scan has points"),
    "trust": Trait("1", "share of the edges that likely need no correction"),
}
"""Unit and definition of each trait of a tree."""
