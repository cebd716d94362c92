"""`plan.json`: the one module that reads and writes a pruning plan.

Its JSON Schema is schemas/plan.json.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from prunus.errors import PrunusError
from prunus.files.reading import record_in
from prunus.files.safely import write_bytes
from prunus.io.skeletons.skeleton_file import InputRecord, SkeletonFile, sha256_of
from prunus.model import Skeleton

Point = tuple[float, float, float]
Positive = Annotated[float, Field(ge=0)]


class _Record(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class ApproachRecord(_Record):
    """How a tool comes to a cut, as far as the scan shows what stands there."""

    direction: Point = Field(description="unit vector in which the tool moves, towards the cut")
    half_angle_deg: float = Field(
        ge=0, le=90, description="of the cone, its tip at the cut, that holds no point of the scan"
    )
    free_within_m: Positive = Field(
        description="how far from the cut that holds; with no cone: the first point in the way"
    )


class RemovedRecord(_Record):
    """What comes down with a cut, all that hangs on it included."""

    length: Positive = Field(description="of all its branches together, m")
    volume: Positive | None = Field(description="m3; null = no radius is known")


class CutRecord(_Record):
    """One cut."""

    id: str = Field(description="rule and branch; the same plan gives the same")
    branch: str = Field(description="by label, numbered along the row: `side branch 7`")
    branch_number: Annotated[int, Field(ge=0)] | None = Field(
        None, description="as `branch` of skeleton.json has it; null = not told"
    )
    rule: Literal["spacing", "height", "side_branches"]
    because: str = Field(description="why the rule asks for it")
    point: Point = Field(description="where the blade meets the axis of the branch")
    blade_normal: Point = Field(
        description="unit vector square to the blade, which moves along the approach; "
        "towards the wood that comes down"
    )
    branch_direction: Point = Field(description="unit vector along the branch, towards its tip")
    approach: ApproachRecord | None = Field(description="null = the cloud was not there")
    diameter: Positive | None = Field(description="of the branch at the cut, m; null = unknown")
    diameter_error: Positive | None = Field(description="one standard deviation, m")
    stub_length: Positive | None = Field(
        description="wood left between the bark of the parent and the blade, m; null where a "
        "leader is shortened"
    )
    wood_removed: RemovedRecord
    confidence: float = Field(ge=0, le=1, description="probability that the cut is right")
    needs_review: bool = Field(description="a person looks before it is made: there are reasons")
    reasons: list[str]


class LeftRecord(_Record):
    """A branch that a rule looked at and left."""

    rule: str
    branch: str
    branch_number: Annotated[int, Field(ge=0)] | None = None
    why: str


class PlanFile(_Record):
    """The contents of `plan.json`."""

    model_config = ConfigDict(title="prunus pruning plan")

    format: Literal["prunus-plan"] = "prunus-plan"
    version: Literal[1, 2] = Field(2, description="2 has all that 1 has, and more")
    frame: Literal["file"] = Field("file", description="all is in the frame of the input file")
    unit: Literal["m"] = "m"
    cuts: list[CutRecord]
    left: list[LeftRecord] = Field(description="why each rule did not ask for more")
    rules: dict[str, dict[str, Any]] = Field(description="as docs/cuts.md has them")
    skeleton: str | None = Field(None, description="the file that was planned on; null = a cloud")
    skeleton_sha256: str | None = Field(
        None, description="of the skeleton that was planned on: docs/files.md; null = not told"
    )
    input: InputRecord | None = Field(None, description="the cloud; null = it was not there")
    notes: list[str] = Field([], description="how the input was read")
    version_of_prunus: str | None = None


def write_plan(path: str | Path, plan: PlanFile) -> None:
    """Write `plan.json`."""
    write_bytes(Path(path), (plan.model_dump_json(indent=1) + "\n").encode())


def read_plan(path: str | Path) -> PlanFile:
    """The plan in a file; PrunusError naming file and field otherwise."""
    return record_in(Path(path), PlanFile)


def check_belongs(
    plan: PlanFile, path: Path, skeleton: Skeleton, record: SkeletonFile | None, source: Path
) -> list[str]:
    """Raise where the plan in a file is not that of the skeleton, and its record, in `source`.

    What is to be said where nobody can tell: plans did not always name their skeleton.
    """
    refined_from = None if record is None else record.refines
    scan = None if record is None else record.input
    if plan.skeleton_sha256 is None:
        belongs = plan.input is None or scan is None or plan.input.sha256 == scan.sha256
    else:
        belongs = plan.skeleton_sha256 in (sha256_of(skeleton), refined_from)
    if not belongs:
        raise PrunusError(
            f"{path}: is the plan of another skeleton, {made_on(plan)}; expected that of {source}"
            f"{'' if scan is None else f' of {scan.file}'}: prunus cuts {source} makes it"
        )
    if plan.skeleton_sha256 is None:
        return [f"{path} does not say of which skeleton it is; look whether it is of {source}"]
    return []


def made_on(plan: PlanFile) -> str:
    """What a plan was made on, in words."""
    scan = "" if plan.input is None else plan.input.file
    return " of ".join(name for name in (plan.skeleton, scan) if name) or "of no name"
