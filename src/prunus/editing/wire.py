"""Values to JSON and back: a frozen dataclass is an object that names its kind under a key."""

from __future__ import annotations

import json
import math
import re
from functools import cache
from typing import Annotated, Any, TypeVar, cast

import numpy as np
from pydantic import (
    ConfigDict,
    Field,
    PlainSerializer,
    PlainValidator,
    TypeAdapter,
    ValidationError,
)

from prunus.files.reading import problem_of, short
from prunus.model import Kind, Label

Value = TypeVar("Value")

Number = Annotated[float, Field(allow_inf_nan=False)]
Length = Annotated[float, Field(allow_inf_nan=False, gt=0)]
Node = Annotated[int, Field(ge=0)]
Point = tuple[Number, Number, Number]
"""A place in the frame of the input file, metres."""


def _place(value: Any) -> int | tuple[float, float, float]:
    if isinstance(value, int) and not isinstance(value, bool) and value >= 0:
        return value
    if isinstance(value, list | tuple) and len(value) == 3 and all(map(_is_number, value)):
        return float(value[0]), float(value[1]), float(value[2])
    raise ValueError(f"found {short(value)}; expected a node (0 or more) or a point x, y, z")


def _is_number(value: Any) -> bool:
    try:
        return isinstance(value, int | float) and math.isfinite(value)
    except OverflowError:
        return False


def _label(value: Any) -> Label:
    if isinstance(value, Label):
        return value
    if not isinstance(value, str):
        raise ValueError(f"found {short(value)}; expected one of {[x.word for x in Label]}")
    return Label.from_word(value)


def _kind(value: Any) -> Kind:
    words = {kind.name.lower(): kind for kind in Kind}
    if isinstance(value, Kind):
        return value
    if not isinstance(value, str) or value not in words:
        raise ValueError(f"found {short(value)}; expected one of {list(words)}")
    return words[value]


Place = Annotated[int | tuple[float, float, float], PlainValidator(_place)]
"""A node of the tree or of its graph, or a free point in the frame of the input file."""
LabelWord = Annotated[
    Label, PlainValidator(_label), PlainSerializer(lambda label: label.word, return_type=str)
]
KindWord = Annotated[
    Kind, PlainValidator(_kind), PlainSerializer(lambda kind: kind.name.lower(), return_type=str)
]


class Checked:
    """What is read from JSON holds just these fields, of just these types."""

    __pydantic_config__ = ConfigDict(extra="forbid", strict=True)


def name_of(kind: type) -> str:
    """The name of a kind in files: add_path, remove_edge, ..."""
    return re.sub(r"(?<=.)([A-Z])", r"_\1", kind.__name__).lower()


def told(value: Any, key: str) -> dict[str, Any]:
    """A value as an object of JSON; ValueError where a field is of no such type."""
    kind: Any = type(value)
    fields = _adapter(kind).dump_python(value, mode="json", warnings=False, fallback=_plain)
    return {key: name_of(kind), **fields}


def read(value: Any, key: str, kinds: tuple[type[Value], ...]) -> Value:
    """The value of one of these kinds that an object of JSON names; ValueError otherwise."""
    if isinstance(value, kinds):
        return value
    if not isinstance(value, dict):
        raise ValueError(f"found {short(value)}; expected an object with {key!r}")
    known: dict[str, Any] = {name_of(kind): kind for kind in kinds}
    rest = dict(value)
    name = rest.pop(key, None)
    if not isinstance(name, str) or name not in known:
        raise ValueError(f"unknown {key} {short(name)}; expected one of {', '.join(known)}")
    try:
        return cast(Value, _adapter(known[name]).validate_json(json.dumps(rest)))
    except ValidationError as error:
        raise ValueError(problem_of(error, name=name)) from error


def _plain(value: Any) -> Any:
    """A number or an array of numpy as JSON has it."""
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    raise ValueError(f"found {short(value)}, which JSON cannot hold")


@cache
def _adapter(kind: Any) -> TypeAdapter[Any]:
    return TypeAdapter(kind)
