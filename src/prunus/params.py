"""Every number a user may change: symbol, unit, range, default (the paper's parameter table)."""

from __future__ import annotations

import json
import math
import operator
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    SerializerFunctionWrapHandler,
    ValidationInfo,
    field_validator,
    model_serializer,
    model_validator,
)

from prunus.errors import PrunusError
from prunus.reading import in_words, read_toml

PI = math.pi
Method = Literal["default", "paper", "learned"]


def _number(default: Any, symbol: str, unit: str, about: str, **limits: Any) -> Any:
    return Field(
        default, description=about, json_schema_extra={"symbol": symbol, "unit": unit}, **limits
    )


class _Group(BaseModel):
    model_config = ConfigDict(
        frozen=True,
        extra="forbid",
        strict=True,
        allow_inf_nan=False,
        revalidate_instances="always",
    )

    @field_validator("*", mode="before")
    @classmethod
    def _plain(cls, value: Any, info: ValidationInfo) -> Any:
        """A scalar of numpy as Python's own; true is not 1."""
        value = value.item() if isinstance(value, np.generic) else value
        if (
            isinstance(value, bool)
            and cls.model_fields[str(info.field_name)].annotation is not bool
        ):
            raise ValueError("input should be no truth value")
        return value


class Input(_Group):
    """What is read of the cloud (docs/method.md)."""

    points: Annotated[int, Field(ge=1)] | Literal["all"] = _number(
        100_000, "P", "points", "points >= 1 drawn at random from the cloud, or 'all'"
    )
    draw: Literal["space", "points"] = _number(
        "points", "draw", "space, points", "space: places much denser than most give no more than "
        "their share; points: each point is as likely as any other, as in the paper"
    )  # fmt: skip

    @property
    def count(self) -> int | None:
        """The number of points; None: all."""
        return None if self.points == "all" else self.points

    @field_validator("points", mode="before")
    @classmethod
    def _none_is_all(cls, value: Any) -> Any:
        return "all" if value is None or value == "none" else value


class Isolation(_Group):
    """One tree out of a raw scan (beyond the paper, where people do it by hand)."""

    isolate: Literal["auto", "always", "never"] = _number(
        "auto", "-", "-", "'auto': where the scan is evidently raw, see raw_from"
    )
    raw_from: float = _number(
        0.08, "-", "1", "a scan is raw when so large a share of it is not the tree", gt=0, lt=1
    )


class Cover(_Group):
    """Superpoint selection."""

    r_super: float = _number(
        0.10, "r_super", "m", "radius of the balls that cover the cloud", ge=0.01, le=1
    )
    min_points: int = _number(
        8, "min_points", "points", "balls with fewer points are noise", ge=1, le=10_000
    )
    place: Literal["axes", "random"] = _number(
        "axes", "-", "-", "'axes': along the branches and where they meet; 'random': as the paper"
    )
    along: float = _number(
        0.08, "-", "m", "a superpoint on an axis covers so much of it to either end", ge=0.01, le=1
    )
    across: float = _number(
        0.04, "-", "m", "and what of the drawn-together cloud is so near the axis", ge=0.01, le=1
    )


class Confidence(_Group):
    """Edge evaluation."""

    alpha_conf: float = _number(
        0.40, "alpha_conf", "1", "edges under this confidence cost score", ge=0, le=0.99
    )
    floor: Annotated[float, Field(ge=0, lt=1)] | Literal["auto"] = _number(
        "auto", "-", "1",
        "edges under 0 <= floor < 1 are left out (beyond the paper); 'auto' as suits the scorer",
    )  # fmt: skip
    edge_net: Literal["ours", "paper"] = _number(
        "ours", "-", "-", "network that gives the confidence: 'ours' or that of the 'paper'"
    )


class Tips(_Group):
    """Tip identification."""

    alpha_tip: float = _number(
        0.60, "alpha_tip", "1", "share of the height, from the top, that may hold tips", gt=0, le=1
    )


class Turn(_Group):
    """TurnPenalty (eq. turnpenalty)."""

    theta: float = _number(PI / 4, "theta_TurnMin", "rad", "turns up to this are free", ge=0, le=PI)
    c: float = _number(0.5, "c_Turn", "1", "factor of the turn penalty", ge=0, le=1000)
    p: float = _number(2.0, "p_Turn", "1", "power of the turn penalty", gt=0, le=10)


class Grow(_Group):
    """GrowPenalty (eq. growpenalty)."""

    theta: float = _number(
        PI / 4, "theta_GrowMin", "rad", "deviations up to this are free", ge=0, le=PI / 2
    )
    c: float = _number(0.3, "c_Grow", "1", "factor of the growth penalty", ge=0, le=1000)
    p: float = _number(1.0, "p_Grow", "1", "power of the growth penalty", gt=0, le=10)


class Search(_Group):
    """The population-based search."""

    K: int = _number(500, "K", "skeletons", "size of the population", ge=1, le=100_000)
    k_max_rep: int = _number(
        3, "k_MaxRep", "skeletons", "copies of one skeleton in the population", ge=1, le=1_000_000
    )
    refine: bool = _number(
        True, "-", "-", "improve the best skeleton one edge at a time (beyond the paper)"
    )


class Leaders(_Group):
    """Stubs (beyond the paper)."""

    min_length: float = _number(
        0.35, "-", "m", "shorter leaders are dropped; 0 keeps all", ge=0, le=10
    )


class SideBranches(_Group):
    """Locating side branches."""

    angle_min: float = _number(
        PI / 4, "90 - 45 deg", "rad", "least angle with the leader", ge=0, le=PI
    )
    angle_max: float = _number(
        3 * PI / 4, "90 + 45 deg", "rad", "greatest angle with the leader", ge=0, le=PI
    )
    turn_max: float = _number(
        PI / 2, "pi / 2", "rad", "greatest turn between edges of a side branch", ge=0, le=PI
    )

    several: bool = _number(
        True, "-", "-", "a loose piece may touch the support and hold several (beyond the paper)"
    )
    min_length: float = _number(
        0.10, "-", "m", "the second and further ones of a piece reach so far", ge=0, le=10
    )

    @model_validator(mode="after")
    def _in_order(self) -> SideBranches:
        if self.angle_min > self.angle_max:
            raise ValueError(f"angle_min {self.angle_min} is over angle_max {self.angle_max}")
        return self


_SHARED = ("input", "isolation")
_SEARCHED = (
    *_SHARED, "superpoints", "confidence", "tips", "turn", "grow", "search", "leaders",
    "side_branches",
)  # fmt: skip
SCORES_NOTHING = (
    'of no use to the method "default", which scores no edges; expected it beside parameters of '
    'method = "paper" (--params paper) alone'
)

GROUPS: dict[Method, tuple[str, ...]] = {
    "default": _SHARED,
    "paper": _SEARCHED,
    "learned": _SEARCHED,
}
"""The groups of parameters by which each method goes."""

_OWN: dict[Method, dict[str, dict[str, Any]]] = {
    "default": {},
    "paper": {
        "input": {"points": 50_000},
        "isolation": {"isolate": "never"},
        "superpoints": {"place": "random"},
        "confidence": {"floor": 0.0, "edge_net": "paper"},
        "search": {"refine": False},
        "leaders": {"min_length": 0.0},
        "side_branches": {"several": False},
    },
    "learned": {"input": {"points": 50_000}},
}
"""Where the defaults of a method are others than those of the groups."""


class Parameters(_Group):
    """The method, and its parameters, one frozen group a stage.

    A method goes by its own groups (`GROUPS`); one of another method is refused. Numbers of the
    paper have its values; what goes beyond it is switched off in `paper()`.
    """

    method: Method = Field(
        "default", description="how a tree is found: 'default' (docs/growth.md) or 'paper'"
    )
    input: Input = Input()
    isolation: Isolation = Isolation()
    superpoints: Cover = Cover()
    confidence: Confidence = Confidence()
    tips: Tips = Tips()
    turn: Turn = Turn()
    grow: Grow = Grow()
    search: Search = Search()
    leaders: Leaders = Leaders()
    side_branches: SideBranches = SideBranches()

    def __init__(self, **groups: Any) -> None:
        """The method and groups as such, or as dicts; PrunusError naming the field otherwise."""
        with in_words("params", type(self), noun="parameter"):
            super().__init__(**groups)

    @model_validator(mode="before")
    @classmethod
    def _of_one_method(cls, values: Any) -> Any:
        """What is not named is as the method has it; what it does not go by is refused."""
        if not isinstance(values, Mapping):
            return values
        values, defaults = _of_older(dict(values))
        method = values.get("method", "default")
        if not isinstance(method, str) or method not in GROUPS:
            return values
        for name, field in cls.model_fields.items():
            if name not in values or name in ("method", *GROUPS[method]):
                continue
            if not isinstance(values[name], _Group) or values[name] != field.default:
                raise ValueError(_foreign(name, method))
        for name, own in _OWN[defaults or method].items():
            given = values.get(name, {})
            values[name] = {**own, **given} if isinstance(given, Mapping) else given
        return values

    @model_serializer(mode="wrap")
    def _told(self, dumped: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """The method, and the groups by which it goes."""
        every = dumped(self)
        return {name: every[name] for name in ("method", *GROUPS[self.method])}

    @classmethod
    def paper(cls) -> Parameters:
        """The method as the paper has it, without what we do beyond it."""
        return cls(method="paper")

    @classmethod
    def learned(cls) -> Parameters:
        """What was the default before; it goes away."""
        return cls(method="learned")

    @classmethod
    def parse(cls, values: Any, source: str = "params") -> Parameters:
        """Parameters from nested dicts, or checked again; PrunusError naming source and field."""
        if isinstance(values, Mapping):
            values = {str(name): group for name, group in values.items()}
        with in_words(source, cls, noun="parameter"):
            return cls.model_validate(values)

    @classmethod
    def from_toml(cls, path: str | Path) -> Parameters:
        """Parameters from a TOML file; what it does not name keeps its default."""
        try:
            path = Path(path)
        except TypeError as error:
            raise PrunusError(f"params: {path!r}; expected the name of a file") from error
        return cls.parse(read_toml(path), str(path))

    def changed(self, group: str, **values: Any) -> Parameters:
        """The same parameters with some values of one group replaced.

        PrunusError where a value is out of bounds, or the method does not go by that group.
        """
        nested = self.model_dump()
        nested[group] = nested.get(group, {}) | values
        return Parameters.parse(nested)

    def to_toml(self) -> str:
        """The file that `from_toml` reads, each value with symbol, unit, range and meaning."""
        about = type(self).model_fields["method"].description
        lines = [f"method = {json.dumps(self.method)}  # {about}", ""]
        for name in GROUPS[self.method]:
            group: BaseModel = getattr(self, name)
            lines += [f"# {(type(group).__doc__ or '').strip()}", f"[{name}]"]
            for key, field in type(group).model_fields.items():
                value = getattr(group, key)
                shown = json.dumps(value)
                lines.append(f"{key} = {shown}  # {_about(field)}")
            lines.append("")
        return "\n".join(lines)


def _of_older(values: dict[str, Any]) -> tuple[dict[str, Any], Method | None]:
    """Values in which `search.score` chose the method, as files had it before there was `method`.

    With them the method whose defaults hold for what they do not name: that of then; None: as now.
    """
    search = values.get("search")
    if "method" in values or not isinstance(search, Mapping) or "score" not in search:
        return values, None
    if search["score"] not in ("learned", "paper"):
        raise ValueError(
            f"search.score: found {search['score']!r}; expected no score, but, above all groups, "
            'method = "default" or "paper"'
        )
    rest = {name: value for name, value in search.items() if name != "score"}
    return values | {"method": search["score"], "search": rest}, "learned"


def _foreign(group: str, method: Method) -> str:
    goes_by = ", ".join(GROUPS[method])
    return (
        f'the method "{method}" does not go by [{group}], but by {goes_by}; [{group}] is of '
        'method = "paper"'
    )


def checked_params(params: Any) -> Parameters:
    """Parameters that a caller gave, as such or as nested dicts, checked; None: ours."""
    return Parameters() if params is None else Parameters.parse(params)


def checked_seed(seed: Any) -> int:
    """A seed that a caller gave; PrunusError where it is no whole number from 0."""
    try:
        number = -1 if isinstance(seed, bool | np.bool_) else operator.index(seed)
    except TypeError:
        number = -1
    if number < 0:
        raise PrunusError(f"seed: {seed!r}; expected a whole number from 0")
    return number


def _about(field: Any) -> str:
    extra = field.json_schema_extra
    limits = ", ".join(
        f"{sign} {getattr(limit, name):.6g}"
        for limit in field.metadata
        for name, sign in (("gt", ">"), ("ge", ">="), ("lt", "<"), ("le", "<="))
        if hasattr(limit, name)
    )
    parts = [extra["symbol"], f"[{extra['unit']}]", limits]
    return " ".join(part for part in parts if part) + f": {field.description}"
