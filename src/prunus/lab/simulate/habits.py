"""The habits of a tree: every range that `grow` draws from, read from a documented TOML file."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from pydantic import BaseModel, ConfigDict

from prunus.files.reading import read_toml

Range = tuple[float, float]
"""A number is drawn evenly between the two."""


class Group(BaseModel):
    """Frozen settings from a file; an unknown name is an error."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class TrunkHabits(Group):
    """Metres, degrees."""

    height: Range
    lean: Range
    radius: Range
    taper: Range


class SupportHabits(Group):
    """Metres, degrees, shares."""

    two: float
    length: Range
    bend: Range
    wave: Range
    wave_length: Range
    climb: Range
    climbing: float
    steep_climb: Range
    swerve: Range
    radius: Range
    taper: Range
    ends_upright: float


class LeaderHabits(Group):
    """Metres, degrees, shares."""

    count: Range
    spacing: Range
    tall: Range
    uneven: Range
    shortest: float
    bend: Range
    tilt: Range
    wander: Range
    ties: Range
    kink: Range
    straighter: Range
    radius: Range
    tip_radius: Range
    runs: float
    run: Range
    crosses: float
    crossing_tilt: Range
    pairs: float
    pair_spacing: Range
    bows: float
    bow: Range
    bow_length: Range
    doubles: float
    double_height: Range
    double_angle: Range


class SideBranchHabits(Group):
    """Metres, degrees, shares."""

    spacing: Range
    first: Range
    length: Range
    long: float
    long_length: Range
    angle: Range
    depthwise: float
    droops: float
    curve: Range
    forks: float
    radius: Range
    upright: float
    upright_bend: Range


class ShootHabits(Group):
    """Metres, counts, shares."""

    on_support: Range
    on_trunk: Range
    length: Range
    tall: float
    radius: Range


class SpurHabits(Group):
    """Metres."""

    spacing: Range
    length: Range
    radius: Range


class StubHabits(Group):
    """Metres, counts."""

    on_support: Range
    on_leader: Range
    length: Range
    radius: Range


class Habits(Group):
    """What a UFO tree is drawn from; see `habits.toml`."""

    trunk: TrunkHabits
    support: SupportHabits
    leader: LeaderHabits
    side_branch: SideBranchHabits
    shoot: ShootHabits
    spur: SpurHabits
    stub: StubHabits


@cache
def ufo_habits() -> Habits:
    """The habits that the package ships."""
    path = Path(__file__).with_name("habits.toml")
    return Habits.model_validate(read_toml(path))
