"""`prunus cuts`: from a skeleton or a cloud to a pruning plan, in the frame of the file."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from prunus import __version__
from prunus.cuts import Cut, CutRules, Plan, plan_cuts
from prunus.cuts.plan import as_it_is
from prunus.cuts.reach import samples
from prunus.errors import NoTreeError, PrunusError, naming
from prunus.files.work_folder import REFINED
from prunus.frames.scan import Scan, open_scan
from prunus.geometry.near import within
from prunus.io.original import original_of
from prunus.io.skeletons.named import names_of
from prunus.io.skeletons.plans import PlanFile
from prunus.io.skeletons.skeleton_file import (
    SkeletonFile,
    known,
    read_record,
    read_skeleton,
    sha256_of,
)
from prunus.model import FRAMES, Floats, Label, PointCloud, RigidMotion, Skeleton
from prunus.names import as_text
from prunus.params import Parameters
from prunus.pipeline import skeletonize
from prunus.refine.radii import Unknown
from prunus.refine.refined import Refined, refined
from prunus.result import REFINED_WITH

if TYPE_CHECKING:
    from prunus.paper.confidence import EdgeScorer

SKELETONS = (".json", ".swc")
OWN = 0.06
"""Points of a scan so near to a skeleton are taken for those of its tree, metres."""
FINE = 0.02
"""A skeleton with nodes so near to each other was refined already, metres."""
SEEN = 0.02
"""Its nodes are seen where a point is so near, metres."""
Place = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class Source:
    """What is planned on, how a cloud is read and skeletonized, and where scans are looked for."""

    path: Path
    base: Place | None = None
    frame: str = "auto"
    unit: str | None = None
    scans: Path | None = None
    params: Parameters = field(default_factory=Parameters)
    seed: int = 0
    scorer: EdgeScorer | None = None

    @property
    def is_skeleton(self) -> bool:
        """Whether there is a skeleton already."""
        return self.path.suffix.lower() in SKELETONS

    def check(self) -> None:
        """Raise PrunusError where it says how to skeletonize what is a skeleton already."""
        asked = {
            "--base": self.base is not None,
            "--params, --points and --no-isolate": self.params != Parameters(),
            "--seed": self.seed != 0,
            "--weights": self.scorer is not None,
        }
        given = [name for name, is_asked in asked.items() if is_asked]
        if self.is_skeleton and given:
            raise PrunusError(f"{given[0]}: of no use, since {self.path} is a skeleton already")


def cut_file(source: Source, rules: CutRules) -> PlanFile:
    """The plan for a skeleton, or for a cloud, which is skeletonized first.

    The cloud of a skeleton is looked for (see `io.original`), and its refined tree beside it: they
    give the plan that the cloud gave. Without a cloud every cut needs review. Raises PrunusError as
    the readers do.
    """
    if source.is_skeleton:
        return _on_skeleton(source, rules)
    scan = open_scan(source.path, source.frame, source.unit)
    with naming(source.path):
        result = skeletonize(scan.cloud, source.base, source.params, source.seed, source.scorer)
    plan = plan_cuts(result.refined, scan.cloud.xyz, rules)
    notes = [*scan.notes, *result.notes, *result.review]
    told = {"skeleton_sha256": sha256_of(result.skeleton), "input": scan.record, "notes": notes}
    return plan_file(plan, scan.cloud.to_input, **told)


def _on_skeleton(source: Source, rules: CutRules) -> PlanFile:
    path, record = source.path, None
    if path.suffix.lower() == ".json":
        skeleton, record = read_record(path)
    else:
        skeleton = read_skeleton(path)
    if len(skeleton) == 1:
        raise NoTreeError(f"{path}: holds a base alone; expected a tree to cut")
    notes = [] if record is None else list(record.review or ())
    told: dict[str, Any] = {
        "skeleton": as_text(path.name),
        "skeleton_sha256": (record and record.refines) or sha256_of(skeleton),
        "notes": notes,
    }
    skeleton, record = _refined_beside(path, skeleton, record) or (skeleton, record)
    scan = None
    try:
        scan = _scan_of(source, record)
    except PrunusError as error:
        if source.scans is not None:
            raise
        notes.append(f"no cloud: {error}")
    if scan is None:
        to_file = RigidMotion(_upright(skeleton, source.frame), np.zeros(3)).inverse()
    else:
        to_file, told["input"] = scan.cloud.to_input, scan.record
        notes += scan.notes
    in_house = skeleton.moved(to_file.inverse())
    cloud = None if scan is None else scan.cloud
    tree = _as_told(in_house, record) or _as_seen(in_house, record, cloud, notes)
    names = names_of(in_house, {} if record is None else record.named)
    plan = plan_cuts(tree, None if cloud is None else cloud.xyz, rules, names, _likely(record))
    return plan_file(plan, to_file, **told)


def _refined_beside(
    path: Path, skeleton: Skeleton, record: SkeletonFile | None
) -> tuple[Skeleton, SkeletonFile] | None:
    """The refined tree that lies beside a skeleton; None where there is none, or that of another.

    So that skeleton.json gives the plan that the scan gave.
    """
    beside = path.with_name(REFINED)
    if record is None or record.refines is not None or not beside.exists():
        return None
    fine, own = read_record(beside)
    return (fine, own) if own.refines == sha256_of(skeleton) else None


def _scan_of(source: Source, whole: SkeletonFile | None) -> Scan:
    """The scan of a skeleton, read as it was when that was made, unless asked otherwise."""
    if whole is None or whole.input is None:
        raise PrunusError(f"{source.path}: does not say of which cloud it is")
    found = original_of(whole.input, source.path.parent, source.scans)
    if whole.read is None or source.frame != "auto" or source.unit is not None:
        return open_scan(found, source.frame, source.unit)
    return open_scan(found, whole.read.frame, whole.read.unit)


def _as_told(skeleton: Skeleton, record: SkeletonFile | None) -> Refined | None:
    """A refined tree as its file has it, house frame; None where it holds none."""
    if record is None or record.radius_error is None or record.seen is None:
        return None
    return Refined(
        skeleton=skeleton,
        radius_error=np.array(known(record.radius_error)),
        unknown=np.where(np.isfinite(skeleton.radius), Unknown.KNOWN, Unknown.FEW_POINTS),
        seen=np.array(record.seen),
        likely=record.likely,
    )


def _as_seen(
    skeleton: Skeleton, record: SkeletonFile | None, cloud: PointCloud | None, notes: list[str]
) -> Refined | Skeleton:
    """A skeleton refined with the points near it, both in the house frame; a fine one as it is.

    Without a cloud it is what it is.
    """
    if cloud is None:
        return skeleton
    likely = _likely(record)
    if np.median(skeleton.lengths[1:]) < FINE:
        seen = np.diff(within(cloud.xyz, skeleton.xyz, SEEN)[0]) > 0
        return replace(
            as_it_is(skeleton, likely), radius_error=np.full(len(seen), np.nan), seen=seen
        )
    notes.append("refined anew with the points near it: a plan of the scan differs by millimetres")
    return refined(skeleton, _own(cloud, skeleton), likely)


def _likely(record: SkeletonFile | None) -> Floats | None:
    return None if record is None else record.likely


def _own(cloud: PointCloud, skeleton: Skeleton) -> PointCloud:
    """The points of a cloud that are near a skeleton, both in the house frame."""
    line = samples(skeleton.xyz, skeleton.parent, np.arange(1, len(skeleton)))
    _, members = within(cloud.xyz, line, OWN)
    own = cloud.take(np.unique(members)) if len(members) else cloud
    return own.sample(REFINED_WITH, np.random.default_rng(0))


def _upright(skeleton: Skeleton, frame: str) -> Floats:
    """The rotation (3, 3) into the house frame: as asked, else such that leaders point up."""
    if frame != "auto":
        return FRAMES[frame]
    leaders = skeleton.edges_with(Label.LEADER)
    ways = skeleton.edge_vectors[leaders if leaders.any() else slice(None)]
    up = {name: float((ways @ turn.T)[:, 2].sum()) for name, turn in FRAMES.items()}
    return FRAMES[max(up, key=lambda name: up[name])]


def plan_file(plan: Plan, to_file: RigidMotion, **evidence: Any) -> PlanFile:
    """A plan in the house frame as a file has it; `evidence`: skeleton, input, notes."""
    return PlanFile.model_validate(
        {
            "cuts": [_record(cut, to_file) for cut in plan.cuts],
            "left": [vars(one) for one in plan.left],
            "rules": plan.rules.model_dump(),
            "version_of_prunus": __version__,
            **evidence,
        }
    )


def _record(cut: Cut, to_file: RigidMotion) -> dict[str, Any]:
    way = cut.approach
    return {
        "id": cut.id,
        "branch": cut.branch,
        "branch_number": cut.branch_number,
        "rule": cut.rule,
        "because": cut.because,
        "point": _rounded(to_file.apply(cut.point), 5),
        "blade_normal": _rounded(to_file.rotation @ cut.blade_normal, 6),
        "branch_direction": _rounded(to_file.rotation @ cut.branch_direction, 6),
        "approach": way and {
            "direction": _rounded(to_file.rotation @ way.direction, 6),
            "half_angle_deg": round(way.half_angle, 1),
            "free_within_m": round(way.free_within, 3),
        },
        "diameter": _known(cut.diameter, 5),
        "diameter_error": _known(cut.diameter_error, 5),
        "stub_length": _known(cut.stub, 4),
        "wood_removed": {
            "length": round(cut.removed_length, 4),
            "volume": _known(cut.removed_volume, 8),
        },
        "confidence": round(cut.confidence, 4),
        "needs_review": cut.needs_review,
        "reasons": list(cut.reasons),
    }  # fmt: skip


def _rounded(values: Floats, digits: int) -> list[float]:
    return [round(value, digits) + 0.0 for value in values.tolist()]


def _known(value: float, digits: int) -> float | None:
    return round(value, digits) if math.isfinite(value) else None


def lines_of(plan: PlanFile) -> list[str]:
    """What the command line says of a plan."""
    lines = [line for cut in plan.cuts for line in _told(cut.model_dump())]
    looked = sum(cut.needs_review for cut in plan.cuts)
    lines.append(f"{len(plan.cuts)} cuts, {looked} of them for a person to look at first")
    lines += [f"  {one.rule}: {one.branch} stays: {one.why}" for one in plan.left]
    return lines + [f"  {note}" for note in plan.notes]


def _told(cut: dict[str, Any]) -> list[str]:
    thick = "" if cut["diameter"] is None else f", {1e3 * cut['diameter']:.0f} mm thick"
    place = ", ".join(f"{value:.3f}" for value in cut["point"])
    first = f"{cut['id']} at ({place}){thick}: {cut['because']}"
    return [first, *(f"  look: {reason}" for reason in cut["reasons"])]
