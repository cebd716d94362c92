"""What the command line prints and writes as JSON beside skeletons, plans and rigs."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

Point = tuple[float, float, float]


class _Record(BaseModel):
    model_config = ConfigDict(
        frozen=True,
        extra="forbid",
        allow_inf_nan=False,
        json_schema_serialization_defaults_required=True,
    )


class EdgesByLabel(_Record):
    """How many edges have each label."""

    trunk: int
    support: int
    leader: int
    side_branch: int


class TreeRecord(_Record):
    """What came of one input: the line of `prunus skeletonize --json`."""

    file: str = Field(description="the input, as it was given or found in a folder")
    ok: bool = Field(description="whether it gave a skeleton; else all but file and error is empty")
    error: str | None = Field(description="what was wrong, and what was expected; null = nothing")
    skeleton: str | None = Field(
        default=None, description="path of the skeleton.json that was written"
    )
    score: float | None = Field(
        default=None, description="SkelScore of the paper's method; null where the method has none"
    )
    points: int | None = Field(default=None, description="of the input")
    superpoints: int | None = Field(default=None, description="nodes of the candidate graph")
    candidates: int | None = Field(default=None, description="edges of the candidate graph")
    edges: int | None = Field(default=None, description="edges of the skeleton")
    tips: int | None = Field(default=None, description="nodes that a skeleton could grow to")
    labels: EdgesByLabel | None = Field(default=None, description="edges of the skeleton by label")
    leaders: int | None = Field(default=None, description="branches of that label")
    side_branches: int | None = Field(default=None, description="branches of that label")
    cpu_s: dict[str, float] | None = Field(
        default=None,
        description="CPU seconds by stage, and `total`; compiling and loading included",
    )
    wall_s: dict[str, float] | None = Field(default=None, description="the same by the clock")
    trust: float | None = Field(
        default=None,
        description="share of the edges that likely need no correction; null = unknown",
    )
    review: list[str] = Field(
        default=[], description="why a person should look before a machine acts; empty: no need"
    )
    warnings: list[str] = Field(
        default=[], description="how the input was read, and what is doubtful"
    )


Measure = int | float | None


class PairRecord(BaseModel):
    """A skeleton against its gold standard: the line of `prunus evaluate --json`.

    Beside the name there are measures: shares, counts, metres; null where one is of nothing. Which
    there are depends on what the pair holds: docs/evaluation.md.
    """

    model_config = ConfigDict(frozen=True, extra="allow", allow_inf_nan=False)
    __pydantic_extra__: dict[str, Measure]

    name: str = Field(description="of the pair: its file, or what is called so in both folders")
    labels: bool = Field(description="whether both have labels; without there is geometry_* alone")
    geometry_recall: Measure = Field(description="share of the gold standard within 5 cm of it")
    geometry_precision: Measure = Field(description="share of it within 5 cm of the gold standard")
    geometry_f1: Measure = Field(description="harmonic mean of both")


class ViewFused(_Record):
    """What became of one view of a rig."""

    name: str
    rotation: tuple[Point, Point, Point] = Field(description="refined, from the view to the rig")
    translation: Point = Field(description="refined, metres")
    points: int = Field(description="that were kept")
    flying: int = Field(description="pixels that were dropped")
    before: float | None = Field(
        description="median distance across branches to the other views in the nominal pose, "
        "metres; null = none is near"
    )
    after: float | None = Field(description="the same in the refined pose")
    agree: float = Field(ge=0, le=1, description="share of its samples that others confirm")
    moved: float = Field(description="from the nominal pose, metres")
    turned: float = Field(description="from the nominal pose, degrees")
    refused: str | None = Field(description="why it was left out; null = it is in")


class FusedFile(_Record):
    """The report of `prunus fuse --report`."""

    format: Literal["prunus-fused"] = "prunus-fused"
    version: Literal[1] = 1
    unit: Literal["m"] = "m"
    views: list[ViewFused]
