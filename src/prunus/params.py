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
from prunus.files.reading import in_words, read_toml

PI = math.pi
MethodName = Literal["default", "paper"]


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
    """What is read of the cloud."""

    points: Annotated[int, Field(ge=1)] | Literal["all"] = _number(
        100_000, "P", "points", "points >= 1 drawn at random from the cloud, or 'all'"
    )

    @property
    def count(self) -> int | None:
        """The number of points; None: all."""
        return None if self.points == "all" else self.points

    @field_validator("points", mode="before")
    @classmethod
    def _none_is_all(cls, value: Any) -> Any:
        return "all" if value is None or value == "none" else value


class Isolation(_Group):
    """One tree out of a raw scan; in the paper people do it by hand."""

    isolate: Literal["auto", "always", "never"] = _number(
        "auto", "-", "-", "'auto': where the scan is evidently raw, see raw_from"
    )
    raw_from: float = _number(
        0.08, "-", "1", "a scan is raw when so large a share of it is not the tree", gt=0, lt=1
    )


class Growth(_Group):
    """What grows on the votes (docs/growth.md)."""

    gap_max: float = _number(
        0.50, "-", "m", "gaps in the wood up to this are bridged; 0 bridges none", ge=0, le=3
    )
    branch_min: float = _number(0.07, "-", "m", "shorter branches are none", ge=0, le=3)
    spur_min: float = _number(
        0.12, "-", "m", "nor are shorter ones most of which looks like a spur", ge=0, le=3
    )


class Cover(_Group):
    """Superpoint selection."""

    r_super: float = _number(
        0.10, "r_super", "m", "radius of the balls that cover the cloud", ge=0.01, le=1
    )
    min_points: int = _number(
        8, "min_points", "points", "balls with fewer points are noise", ge=1, le=10_000
    )


class Confidence(_Group):
    """Edge evaluation."""

    alpha_conf: float = _number(
        0.40, "alpha_conf", "1", "edges under this confidence cost score", ge=0, le=0.99
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

    @model_validator(mode="after")
    def _in_order(self) -> SideBranches:
        if self.angle_min > self.angle_max:
            raise ValueError(f"angle_min {self.angle_min} is over angle_max {self.angle_max}")
        return self


_SHARED = ("input", "isolation")
SCORES_NOTHING = (
    'of no use to the method "default", which scores no edges; expected it beside parameters of '
    'method = "paper" (--params paper) alone'
)

GROUPS: dict[MethodName, tuple[str, ...]] = {
    "default": (*_SHARED, "growth"),
    "paper": (
        *_SHARED, "superpoints", "confidence", "tips", "turn", "grow", "search", "side_branches",
    ),
}  # fmt: skip
"""The groups of parameters by which each method goes."""

_OWN: dict[MethodName, dict[str, dict[str, Any]]] = {
    "default": {},
    "paper": {"input": {"points": 50_000}, "isolation": {"isolate": "never"}},
}
"""Where the defaults of a method are others than those of the groups."""


class Parameters(_Group):
    """The method, and its parameters, one frozen group a stage.

    A method goes by its own groups (`GROUPS`); one of another method is refused. Numbers of the
    paper have its values.
    """

    method: MethodName = Field(
        "default", description="how a tree is found: 'default' (docs/growth.md) or 'paper'"
    )
    input: Input = Input()
    isolation: Isolation = Isolation()
    growth: Growth = Growth()
    superpoints: Cover = Cover()
    confidence: Confidence = Confidence()
    tips: Tips = Tips()
    turn: Turn = Turn()
    grow: Grow = Grow()
    search: Search = Search()
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
        values = _without_removed(values)
        method = values.get("method", "default")
        if not isinstance(method, str) or method not in GROUPS:
            return values
        for name, field in cls.model_fields.items():
            if name not in values or name in ("method", *GROUPS[method]):
                continue
            if not isinstance(values[name], _Group) or values[name] != field.default:
                raise ValueError(_foreign(name, method))
        for name, own in _OWN[method].items():
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
        """The method as the paper has it."""
        return cls(method="paper")

    @classmethod
    def parse(cls, values: Any, source: str = "params") -> Parameters:
        """Parameters from nested dicts, or checked again; PrunusError naming source and field."""
        if isinstance(values, Mapping):
            values = {str(name): group for name, group in values.items()}
        with in_words(source, cls, noun="parameter"):
            return cls.model_validate(values)

    @classmethod
    def of_record(cls, values: Any, source: str) -> Parameters:
        """Those that are stored beside a result; of a method that is gone, the default's.

        What it made is kept beside it, or is not to be had again. PrunusError as of `parse`.
        """
        gone = isinstance(values, Mapping) and _method_of(values) == GONE
        return cls() if gone else cls.parse(values, source)

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


GONE = "learned"
"""The method that was the default of 0.1."""
_ANY: Any = object()
_REMOVED: dict[str, dict[str, Any]] = {
    "input": {"draw": "points"},
    "superpoints": {"place": "random", "along": _ANY, "across": _ANY},
    "confidence": {"floor": 0.0, "edge_net": "paper"},
    "search": {"score": "paper", "refine": False},
    "leaders": {"min_length": 0.0},
    "side_branches": {"several": False, "min_length": _ANY},
}
"""What files of 0.1 name and nothing has any more, with what the paper's method had there always;
any where nothing came of it then."""


def _method_of(values: Mapping[str, Any]) -> Any:
    """The method that values name, or named by `search.score` before there was `method`."""
    search = values.get("search")
    score = search.get("score") if isinstance(search, Mapping) else None
    return values.get("method", score or "default")


def _without_removed(values: Mapping[str, Any]) -> dict[str, Any]:
    """Values less what older files name and is gone; ValueError where that said something else."""
    left = dict(values)
    if _method_of(values) == GONE:
        where = "method" if "method" in values else "search.score"
        raise ValueError(
            f"{where}: found {GONE!r}, the method of prunus 0.1, which is gone since 0.2; "
            'expected method = "default" with none of its groups, or method = "paper"'
        )
    for name, removed in _REMOVED.items():
        group = values.get(name)
        if not isinstance(group, Mapping) or not removed.keys() & group.keys():
            continue
        for key in removed.keys() & group.keys():
            _check_removed(f"{name}.{key}", group[key], removed[key])
        left[name] = {key: value for key, value in group.items() if key not in removed}
        if not left[name]:
            del left[name]
    left.setdefault("method", _method_of(values))
    return left


def _check_removed(name: str, found: Any, kept: Any) -> None:
    """Raise ValueError where what is gone had another value than the paper's method had always."""
    if kept is _ANY or (found == kept and isinstance(found, bool) == isinstance(kept, bool)):
        return
    raise ValueError(
        f"{name}: found {found!r}, of the method of prunus 0.1, which is gone since 0.2; leave "
        f"{name} out (the paper's method has {kept!r})"
    )


def _foreign(group: str, method: MethodName) -> str:
    goes_by = ", ".join(GROUPS[method])
    other = next(name for name, groups in GROUPS.items() if group in groups)
    return (
        f'the method "{method}" does not go by [{group}], but by {goes_by}; [{group}] is of '
        f'method = "{other}"'
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
