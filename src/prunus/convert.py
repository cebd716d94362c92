"""From one kind of file to another."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from prunus.errors import OptionError, PrunusError, blaming_the_command
from prunus.io.clouds import check_kind, read_cloud, write_cloud
from prunus.io.cylinders import write_cylinders, write_treeqsm
from prunus.io.export import write_graphml, write_ply
from prunus.io.gltf import write_gltf
from prunus.io.mtg import write_mtg
from prunus.io.obj import write_obj
from prunus.io.plans import read_plan
from prunus.io.ros import facing, write_mcap
from prunus.io.skeletons import EVIDENCE, read_record, read_skeleton, write_skeleton
from prunus.io.swc import write_swc
from prunus.io.treetext import write_treetext
from prunus.model import Floats, Skeleton

THIN = 0.005
"""Metres: the radius of tubes and cylinders where it is unknown."""


@dataclass(frozen=True)
class Format:
    """A kind of file for skeletons: how it is written, what it has no place for, what it needs.

    Tubes and cylinders need an edge and a radius. `remark`: what is there in another way than one
    expects.
    """

    write: Callable[[Path, Skeleton], None]
    lacks: tuple[str, ...] = ("confidence", "superpoint")
    needs: tuple[str, ...] = ("edge", "radius")
    remark: str = ""


NAMES_ONLY = "labels are but the names of meshes and materials"
FORMATS: dict[str, Format] = {
    ".json": Format(write_skeleton, (), ()),
    ".swc": Format(write_swc, needs=(), remark="labels are types 16 to 19; an unknown radius is 0"),
    ".ply": Format(write_ply, needs=(), remark="an unknown radius is 0"),
    ".graphml": Format(write_graphml, (), ()),
    ".glb": Format(write_gltf, remark=NAMES_ONLY),
    ".gltf": Format(write_gltf, remark=NAMES_ONLY),
    ".obj": Format(write_obj, remark=NAMES_ONLY),
    ".mtg": Format(write_mtg, ("superpoint",), ("edge",), "labels are the classes T, S, L, B"),
    ".cylinders.csv": Format(write_cylinders, ("superpoint",)),
    ".treeqsm.csv": Format(write_treeqsm, remark="no mad, no SurfCov: nothing was fitted"),
    ".txt": Format(write_treetext, remark="the tree text of raycloudtools; labels are 0 to 3"),
    ".mcap": Format(write_mcap, remark="labels are the namespaces of the markers"),
}
"""By the ending of the file."""


def convert_file(
    source: Path,
    target: Path,
    unit: str | None = None,
    cloud: Path | None = None,
    cuts: Path | None = None,
) -> list[str]:
    """Convert a skeleton or a cloud; returns notes on what the target cannot hold.

    `cloud` and `cuts`, a pruning plan, go into a bag beside the tree. PrunusError where source or
    target is of no such kind.
    """
    if source.suffix.lower() not in (".json", ".swc"):
        check_kind(target)
        held = read_cloud(source, unit)
        write_cloud(target, held.xyz, held.rgb)
        return held.notes
    kind = kind_of(target)
    for name, path in (("cloud", cloud), ("cuts", cuts)):
        if path is not None and kind != ".mcap":
            raise OptionError(f"{target}: holds no {name}; expected a bag (.mcap)")
    if kind == ".json" == source.suffix.lower():
        skeleton, record = read_record(source)
        write_skeleton(target, skeleton, **record.model_dump(include=EVIDENCE))
        return []
    skeleton = read_skeleton(source)
    notes, needs = notes_on(skeleton, FORMATS[kind]), FORMATS[kind].needs
    if "edge" in needs and len(skeleton) == 1:
        raise PrunusError(f"{source}: holds a base alone; expected at least one edge")
    if "radius" in needs:
        skeleton = skeleton.with_radius(np.nan_to_num(skeleton.radius, nan=THIN))
    if kind != ".mcap":
        FORMATS[kind].write(target, skeleton)
        return notes
    points = None
    if cloud is not None:
        with blaming_the_command():
            held = read_cloud(cloud, unit)
        points = held.xyz, held.rgb
        notes += _rounding(held.xyz)
    write_mcap(target, skeleton, points, None if cuts is None else _poses(cuts))
    return notes


def _poses(plan: Path) -> tuple[Floats, Floats]:
    """Places (C, 3) and orientations (C, 4) of the cuts in a plan: Z the blade's normal, X the way.

    Where no way is known, X lies anywhere.
    """
    with blaming_the_command():
        cuts = read_plan(plan).cuts
    places = np.array([cut.point for cut in cuts]).reshape(-1, 3)
    normal = np.array([cut.blade_normal for cut in cuts]).reshape(-1, 3)
    way = np.array([cut.approach.direction if cut.approach else (0, 0, 0) for cut in cuts])
    return places, facing(normal, way.reshape(-1, 3))


def kind_of(target: Path) -> str:
    """The key in `FORMATS` of a file to be written; PrunusError where it is none."""
    kind = next((ending for ending in FORMATS if target.name.lower().endswith(ending)), None)
    if kind is None:
        raise OptionError(
            f"{target}: skeletons are not written as {target.suffix!r}; "
            f"expected one of {' '.join(FORMATS)}"
        )
    return kind


def notes_on(skeleton: Skeleton, form: Format) -> list[str]:
    """What of a skeleton a kind of file does not hold, and what it holds in another way."""
    known = {
        "confidence": np.isfinite(skeleton.confidence).any(),
        "superpoint": (skeleton.superpoint >= 0).any(),
    }
    lost = [name for name in form.lacks if known[name]]
    notes = [f"left out, as there is no place for it: {', '.join(lost)}"] if lost else []
    thin = int(np.isnan(skeleton.radius).sum())
    if "radius" in form.needs and thin:
        notes.append(
            f"the radius is unknown at {thin} of {len(skeleton)} nodes: "
            f"{1e3 * THIN:g} mm was taken there"
        )
    return [*notes, *([form.remark] if form.remark else [])]


def _rounding(xyz: Floats) -> list[str]:
    """What single precision makes of points (P, 3), where that is over a tenth of a millimetre."""
    step = 1e3 * float(np.spacing(np.abs(xyz).max().astype(np.float32)))
    if step < 0.1:
        return []
    return [f"the points are in single precision: so far from the origin to {step:.3g} mm"]
