"""What every reader of small files begins with: bytes, text, TOML, JSON, records of ours.

Whatever is wrong with a file is a PrunusError of one line, which names the file and the field.
"""

from __future__ import annotations

import codecs
import json
import re
import reprlib
import stat
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar, get_args

from pydantic import BaseModel, ValidationError

from prunus.errors import PrunusError

Model = TypeVar("Model", bound=BaseModel)

UTF_16 = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
"""How text in UTF-16 begins, and in UTF-32 of the usual order."""


def read_bytes(path: Path, *, empty: bool = False) -> bytes:
    """The whole file; PrunusError where it is missing, no file, unreadable or (if not) empty."""
    try:
        check_kind(path)
        content = path.read_bytes()
    except OSError as error:
        raise PrunusError(f"{path}: cannot be read ({error.strerror})") from error
    except MemoryError as error:
        raise PrunusError(f"{path}: too large for the memory there is") from error
    if not content and not empty:
        raise PrunusError(f"{path}: the file is empty")
    return content


def check_kind(path: Path) -> None:
    """Raise PrunusError on a pipe or a device, which may never end, or never begin."""
    mode = path.stat().st_mode
    if not (stat.S_ISREG(mode) or stat.S_ISDIR(mode)):
        raise PrunusError(f"{path}: a pipe or a device; expected a file")


def text_of(content: bytes, source: Path | str, *, lenient: bool = False) -> str:
    """Bytes as UTF-8, without the mark that Notepad and Excel put first.

    lenient: what is no UTF-8 becomes a question mark, as in comments of old files. PrunusError
    naming `source` on any other text, or none.
    """
    if content.startswith(UTF_16):
        raise PrunusError(f"{source}: is text in UTF-16; expected UTF-8: save it again as that")
    if b"\0" in content:
        raise PrunusError(f"{source}: holds zero bytes, as no text in UTF-8 does; expected that")
    try:
        return content.decode("utf-8-sig", "replace" if lenient else "strict")
    except UnicodeDecodeError as error:
        found = f"byte {error.start + 1} is 0x{content[error.start]:02x}"
        raise PrunusError(f"{source}: {found}, which is no UTF-8; expected text in that") from error


def read_text(path: Path, *, lenient: bool = False) -> str:
    """The text of a file, as `text_of` has it."""
    return text_of(read_bytes(path), path, lenient=lenient)


def lines_of(text: str) -> list[str]:
    """The lines of a text, which end as files' lines do, and at no other sign."""
    return re.split(r"\r\n|\n|\r", text)


def read_toml(path: Path) -> dict[str, Any]:
    """The tables of a TOML file, which may be empty; PrunusError where it is none."""
    text = text_of(read_bytes(path, empty=True), path)
    try:
        return tomllib.loads(text)
    except RecursionError as error:
        raise PrunusError(f"{path}: not a TOML file: nested too deep") from error
    except ValueError as error:  # also numbers of thousands of digits
        raise PrunusError(f"{path}: not a TOML file: {error}") from error


def json_of(text: str, source: Path | str) -> Any:
    """What a text of JSON says; PrunusError naming `source` otherwise, also on NaN or a key twice.

    Other readers take the last of two keys, or the first, without a word.
    """
    try:
        return json.loads(text, parse_constant=_no_number, object_pairs_hook=_each_once)
    except RecursionError as error:
        raise PrunusError(f"{source}: not JSON: nested too deep") from error
    except ValueError as error:
        raise PrunusError(f"{source}: not JSON: {error}") from error


def record_in(path: Path, model: type[Model]) -> Model:
    """The record of a model in a file of JSON; PrunusError naming file and field otherwise."""
    return record_of(model, json_of(read_text(path), path), path)


def record_of(model: type[Model], held: Any, source: Path | str, name: str = "") -> Model:
    """A record from what JSON said, of that name: numbers must be numbers, and words words."""
    try:
        text = json.dumps(held)
    except RecursionError as error:
        raise PrunusError(f"{source}: nested too deep") from error
    with in_words(source, model, name=name):
        return model.model_validate_json(text, strict=True)


@contextmanager
def in_words(
    source: Path | str, model: type[BaseModel] | None = None, *, name: str = "", noun: str = "field"
) -> Iterator[None]:
    """What pydantic finds wrong inside as a PrunusError of one line: see `problem_of`."""
    try:
        yield
    except ValidationError as error:
        problem = problem_of(error, model, name=name, noun=noun)
        raise PrunusError(f"{source}: {problem}") from error


def problem_of(
    error: ValidationError,
    model: type[BaseModel] | None = None,
    *,
    name: str = "",
    noun: str = "field",
) -> str:
    """The first thing that is wrong: where (below `name`), what was found, what was expected.

    `noun` is what a name that the model does not know would be.
    """
    first = error.errors(include_url=False)[0]
    kind, parts = first["type"], first["loc"]
    if kind == "extra_forbidden":
        known = [] if model is None else _names_beside(model, parts)
        expected = f"; expected one of {', '.join(known)}" if known else ""
        return _joined(name, parts, f"unknown {noun}{expected}")
    parts = tuple(part for part in parts if isinstance(part, int) or part.isidentifier())
    if kind == "missing":
        return _joined(name, parts, "missing")
    message = first["msg"].removeprefix("Value error, ").removeprefix("params: ")
    if kind == "value_error":
        return _joined(name, parts, message)
    return _joined(name, parts, f"{message[0].lower()}{message[1:]}; found {short(first['input'])}")


def short(value: Any) -> str:
    """A value in a message: on one line, and not too long, however long or deep it is."""
    shown = _SHORT.repr(value).replace("\n", " ")
    return shown if len(shown) <= 60 else shown[:57] + "..."


_SHORT = reprlib.Repr()
_SHORT.maxlevel, _SHORT.maxstring, _SHORT.maxother = 3, 60, 60


def _joined(name: str, parts: tuple[int | str, ...], problem: str) -> str:
    """A problem, and before it where it is, unless it is with the whole."""
    where = ".".join(part for part in (name, *map(str, parts)) if part)
    return f"{where}: {problem}" if where else problem


def _names_beside(model: type[BaseModel], parts: tuple[int | str, ...]) -> list[str]:
    """The fields that stand beside one that nobody knows; none where that is not in a model."""
    here: type[BaseModel] | None = model
    for part in parts[:-1]:
        if isinstance(part, str) and here is not None:
            field = here.model_fields.get(part)
            here = None if field is None else _model_in(field.annotation)
    return [] if here is None else sorted(here.model_fields)


def _model_in(annotation: Any) -> type[BaseModel] | None:
    """The model in an annotation such as `list[Model] | None`."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next((found for part in get_args(annotation) if (found := _model_in(part))), None)


def _no_number(text: str) -> float:
    raise ValueError(f"{text} is no number")


def _each_once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    held = dict(pairs)
    if len(held) < len(pairs):
        keys = [key for key, _ in pairs]
        twice = next(key for key in keys if keys.count(key) > 1)
        raise ValueError(f"the key {twice!r} stands twice")
    return held
