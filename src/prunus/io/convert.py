"""From one kind of file to another."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from prunus.errors import OptionError, PrunusError, blaming_the_command
from prunus.io.clouds.cloud_file import check_kind, read_cloud, write_cloud
from prunus.io.meshes.gltf import write_gltf
from prunus.io.meshes.obj import write_obj
from prunus.io.ros.write import CutPoses, facing, write_mcap
from prunus.io.skeletons.cylinders import write_cylinders, write_treeqsm
from prunus.io.skeletons.dxf import write_dxf
from prunus.io.skeletons.export import write_graphml, write_ply
from prunus.io.skeletons.mtg import write_mtg
from prunus.io.skeletons.plans import check_belongs, read_plan
from prunus.io.skeletons.skeleton_file import (
    EVIDENCE,
    SkeletonFile,
    read_record,
    read_skeleton,
    write_skeleton,
)
from prunus.io.skeletons.swc import write_swc
from prunus.io.skeletons.treetext import write_treetext
from prunus.model import Floats, Skeleton
from prunus.model.arrays import Bytes

THIN = 0.005
"""Metres: the radius of tubes and cylinders where it is unknown."""


@dataclass(frozen=True, kw_only=True)
class Format:
    """A kind of file for skeletons: how it is written, what it has no place for, what it needs.

    Tubes and cylinders need an edge and a radius. `remark`: what is there in another way than one
    expects. `names_branches`: it is written with their names.
    """

    write: Callable[..., None]
    lacks: tuple[str, ...] = ("confidence", "superpoint")
    needs: tuple[str, ...] = ("edge", "radius")
    remark: str = ""
    names_branches: bool = False

    def ready(self, skeleton: Skeleton) -> Skeleton:
        """The skeleton with a radius everywhere, where one is needed."""
        if "radius" not in self.needs:
            return skeleton
        return skeleton.with_radius(np.nan_to_num(skeleton.radius, nan=THIN))


NAMES_ONLY = "labels are but the names of meshes and materials"
FORMATS: dict[str, Format] = {
    ".json": Format(write=write_skeleton, lacks=(), needs=()),
    ".swc": Format(
        write=write_swc, needs=(), remark="labels are types 16 to 19; an unknown radius is 0"
    ),
    ".ply": Format(write=write_ply, needs=(), remark="an unknown radius is 0"),
    ".dxf": Format(
        write=write_dxf,
        lacks=("confidence", "superpoint", "radius"),
        needs=("edge",),
        remark="labels are layers and colours",
    ),
    ".graphml": Format(write=write_graphml, lacks=(), needs=()),
    ".glb": Format(write=write_gltf, remark=NAMES_ONLY, names_branches=True),
    ".gltf": Format(write=write_gltf, remark=NAMES_ONLY, names_branches=True),
    ".obj": Format(write=write_obj, remark=NAMES_ONLY, names_branches=True),
    ".mtg": Format(
        write=write_mtg,
        lacks=("superpoint",),
        needs=("edge",),
        remark="labels are the classes T, S, L, B",
        names_branches=True,
    ),
    ".cylinders.csv": Format(write=write_cylinders, lacks=("superpoint",)),
    ".treeqsm.csv": Format(
        write=write_treeqsm,
        lacks=("confidence", "superpoint", "label"),
        remark="no mad, no SurfCov: nothing was fitted",
    ),
    ".txt": Format(
        write=write_treetext, remark="the tree text of raycloudtools; labels are 0 to 3"
    ),
    ".mcap": Format(write=write_mcap, remark="labels are the namespaces of the markers"),
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
        return _cloud_converted(source, target, unit)
    kind = kind_of(target)
    for name, path in (("cloud", cloud), ("cuts", cuts)):
        if path is not None and kind != ".mcap":
            raise OptionError(f"{target}: holds no {name}; expected a bag (.mcap)")
    skeleton, record = _skeleton_in(source)
    if kind == ".json" and record is not None:
        write_skeleton(target, skeleton, **record.model_dump(include=EVIDENCE))
        return []
    form = FORMATS[kind]
    if "edge" in form.needs and len(skeleton) == 1:
        raise PrunusError(f"{source}: holds a base alone; expected at least one edge")
    notes, more = notes_on(skeleton, form), list[Any]()
    if kind == ".mcap":
        points, said = _points_in(cloud, unit)
        poses, told = _cuts_in(cuts, source, skeleton, record)
        notes, more = [*notes, *said, *told], [points, poses]
    elif form.names_branches:
        more = [{} if record is None else record.named]
    form.write(target, form.ready(skeleton), *more)
    return notes


def _cloud_converted(source: Path, target: Path, unit: str | None) -> list[str]:
    """Convert a cloud; returns notes on it."""
    check_kind(target)
    held = read_cloud(source, unit)
    write_cloud(target, held.xyz, held.rgb)
    return held.notes


def _skeleton_in(source: Path) -> tuple[Skeleton, SkeletonFile | None]:
    """A skeleton, and what its file says beside it, if that is one of ours."""
    if source.suffix.lower() == ".json":
        return read_record(source)
    return read_skeleton(source), None


def _points_in(
    cloud: Path | None, unit: str | None
) -> tuple[tuple[Floats, Bytes | None] | None, list[str]]:
    """The points and colours of a cloud, and what is to be said of them."""
    if cloud is None:
        return None, []
    with blaming_the_command():
        held = read_cloud(cloud, unit)
    return (held.xyz, held.rgb), _rounding(held.xyz)


def _cuts_in(
    path: Path | None, source: Path, skeleton: Skeleton, record: SkeletonFile | None
) -> tuple[CutPoses | None, list[str]]:
    """The poses of a plan, which must be that of the skeleton, and what is to be said of them.

    Z is the blade's normal, X the way, or anywhere square to it where no way is known.
    """
    if path is None:
        return None, []
    with blaming_the_command():
        plan = read_plan(path)
        notes = check_belongs(plan, path, skeleton, record, source)
    places = np.array([cut.point for cut in plan.cuts]).reshape(-1, 3)
    normal = np.array([cut.blade_normal for cut in plan.cuts]).reshape(-1, 3)
    way = [cut.approach.direction if cut.approach else (0, 0, 0) for cut in plan.cuts]
    turns = facing(normal, np.array(way).reshape(-1, 3))
    review = np.array([cut.needs_review for cut in plan.cuts], np.bool_)
    looked = f"{len(review)} cuts, {int(review.sum())} of them in /cuts/review, to be looked at"
    return CutPoses(ids=[cut.id for cut in plan.cuts], places=places, turns=turns, review=review), [
        *notes,
        looked,
    ]


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
        "radius": np.isfinite(skeleton.radius).any(),
        "label": True,
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
