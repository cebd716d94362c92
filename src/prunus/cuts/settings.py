"""The rules' numbers: read from a small TOML file, checked, documented in docs/cuts.md."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, Field, model_validator

from prunus.files.reading import in_words, read_toml

SHIPPED = Path(__file__).with_name("cuts.toml")
"""The rules that the package ships."""


class _Group(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)


class SideBranches(_Group):
    """Remove side branches of leaders that are longer than a limit."""

    apply: bool = True
    longer_than: float = Field(gt=0, le=5)
    stub: float = Field(ge=0, le=0.5)

    @model_validator(mode="after")
    def _leaves_less(self) -> SideBranches:
        if self.stub >= self.longer_than:
            raise ValueError(f"stub {self.stub} is not under longer_than {self.longer_than}")
        return self


class Spacing(_Group):
    """Remove the weaker of two leaders that stand too close at mid height."""

    apply: bool = True
    closest: float = Field(gt=0, le=2)
    stub: float = Field(ge=0, le=0.5)
    always_review: bool = True


class Height(_Group):
    """Shorten leaders that stand too high over the support."""

    apply: bool = True
    over: float = Field(gt=0, le=20)
    to: float = Field(gt=0, le=20)
    always_review: bool = True

    @model_validator(mode="after")
    def _in_order(self) -> Height:
        if self.to > self.over:
            raise ValueError(f"to {self.to} is above over {self.over}")
        return self


class Review(_Group):
    """When a person looks at a cut before it is made."""

    confidence: float = Field(ge=0, le=1)
    way: float = Field(ge=0, le=1)
    behind: float = Field(ge=0, le=1)
    past: float = Field(ge=0)
    level: float = Field(ge=0, le=90)
    near_limit: float = Field(ge=0, le=1)
    hidden: float = Field(ge=0, le=1)
    other_wood: float = Field(ge=0, le=1)
    thick: float = Field(gt=0, le=10)
    stout: float = Field(gt=0, le=1)
    seen: float = Field(ge=0, le=1)
    free_angle: float = Field(ge=0, le=90)


class CutRules(_Group):
    """All rules of a plan; see `cuts.toml`. What a file does not name is as shipped."""

    side_branches: SideBranches
    spacing: Spacing
    height: Height
    review: Review

    @classmethod
    def parse(cls, values: dict[str, Any], source: str) -> CutRules:
        """Rules from nested dicts over the shipped ones; PrunusError naming source and field."""
        merged = dict(_shipped_values())
        for name, group in values.items():
            whole = isinstance(group, dict) and isinstance(merged.get(name), dict)
            merged[name] = {**merged[name], **group} if whole else group
        with in_words(source, cls, noun="key"):
            return cls.model_validate(merged)

    @classmethod
    def from_toml(cls, path: str | Path) -> CutRules:
        """Rules from a TOML file; PrunusError where it is none, or holds what no rule knows."""
        path = Path(path)
        return cls.parse(read_toml(path), str(path))


@cache
def shipped_rules() -> CutRules:
    """The rules that the package ships."""
    return CutRules.parse({}, str(SHIPPED))


@cache
def _shipped_values() -> dict[str, Any]:
    return read_toml(SHIPPED)
