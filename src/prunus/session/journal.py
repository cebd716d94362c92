"""The journal: what was done to one tree, one line of JSON after another, only ever longer.

The first line says on what; each further one is an act, an `undo` or a `redo`, and what it gave. A
last line without its end, as a machine that dies leaves it, is dropped; anything else that is
wrong is told by file and line, and the file stays as it is.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict

from prunus.editing.acts import SetStatus, from_json, to_json
from prunus.errors import PrunusError
from prunus.files.jsonl import append_at, ended, object_in, whole_lines
from prunus.files.reading import record_of
from prunus.files.safely import write_bytes
from prunus.files.work_folder import JOURNAL, LABELS
from prunus.io.clouds.units import Unit
from prunus.io.skeletons.skeleton_file import InputRecord
from prunus.model.cloud import FRAMES
from prunus.params import Parameters
from prunus.session.timeline import Line, Move, Timeline

Status = Literal["new", "in work", "done"]


class Head(BaseModel):
    """The first line: the input and how the machine was run on it.

    `frame` and `unit` as they were asked for; `base` that was given to the chain; `superpoints` a
    digest of the nodes that the acts name by number; `gives` one of the machine's skeleton.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    format: Literal["prunus-journal"] = "prunus-journal"
    version: Literal[1] = 1
    input: InputRecord
    params: dict[str, Any]
    seed: int
    frame: str
    unit: Unit | None
    base: tuple[float, float, float] | None
    superpoints: str
    gives: str
    version_of_prunus: str


@dataclass(frozen=True)
class Journal:
    """What a file holds."""

    head: Head
    lines: tuple[Line, ...]


def read_journal(path: Path) -> Journal | None:
    """The journal of a file; None where there is none, or an empty one.

    Raises PrunusError naming file and line, what was found and what was expected.
    """
    try:
        content = path.read_bytes()
    except FileNotFoundError:
        return None
    except OSError as error:
        raise PrunusError(f"{path}: cannot be read ({error.strerror})") from error
    if not content:
        return None
    lines = whole_lines(content)
    if not lines:
        raise PrunusError(f"{path}:1: not a journal; expected one that begins with its input")
    head = _head(path, lines[0])
    read = tuple(_line(path, number, text) for number, text in enumerate(lines[1:], 2))
    _check_moves(path, read)
    return Journal(head, read)


def _object(path: Path, number: int, text: bytes) -> dict[str, Any]:
    return object_in(text, f"{path}:{number}")


def _head(path: Path, text: bytes) -> Head:
    head = record_of(Head, _object(path, 1, text), f"{path}:1", "head")
    if head.frame not in (*FRAMES, "auto"):
        known = ", ".join(FRAMES)
        raise PrunusError(f"{path}:1: unknown frame {head.frame!r}; expected auto, {known}")
    Parameters.of_record(head.params, f"{path}:1")
    return head


def _line(path: Path, number: int, text: bytes) -> Line:
    held = _object(path, number, text)
    at, gives = held.pop("at", None), held.pop("gives", None)
    where = f"{path}:{number}"
    try:
        datetime.fromisoformat(at)
    except (TypeError, ValueError):
        raise PrunusError(f"{where}: at: found {at!r}; expected a date and time") from None
    if gives is not None and not isinstance(gives, str):
        raise PrunusError(f"{where}: gives: found {gives!r}; expected text")
    try:
        move: Move = held["act"] if held in ({"act": "undo"}, {"act": "redo"}) else from_json(held)
    except PrunusError as error:
        raise PrunusError(f"{where}: {error}") from error
    return Line(number=number, at=at, move=move, gives=gives)


def _check_moves(path: Path, lines: tuple[Line, ...]) -> None:
    """Raise PrunusError where there was nothing to undo or to redo."""
    timeline = Timeline()
    for line in lines:
        if not timeline.can(line.move):
            raise PrunusError(f"{path}:{line.number}: nothing to {line.move}")
        timeline = timeline.after(line)


def status_of(folder: Path) -> Status:
    """How far a tree is, by the files in its work folder; PrunusError on a corrupt journal."""
    journal = read_journal(folder / JOURNAL)
    timeline = Timeline.of(journal.lines if journal else ())
    said = [act.done for act in timeline.standing if isinstance(act, SetStatus)]
    if said and said[-1]:
        return "done"
    touched = timeline.position > 0 or _has_lines(folder / LABELS)
    return "in work" if touched else "new"


def _has_lines(path: Path) -> bool:
    """Whether a file goes on after its head."""
    try:
        return path.read_bytes().count(b"\n") > 1
    except OSError:
        return False


@dataclass(frozen=True)
class End:
    """Where the next line goes: so many bytes and lines are there."""

    size: int
    number: int


def begin(path: Path, head: Head) -> End:
    """Write a new journal."""
    line = (json.dumps(head.model_dump(mode="json")) + "\n").encode()
    write_bytes(path, line)
    return End(len(line), 2)


def resume(path: Path, journal: Journal) -> End:
    """Go on with a journal; a torn last line is taken away, the last whole one ended."""
    return End(ended(path), 2 + len(journal.lines))


def append(path: Path, end: End, move: Move, gives: str) -> tuple[Line, End]:
    """Write a line, and wait until it is on the disk; errors are those of `append_at`."""
    now = datetime.now(UTC).isoformat(timespec="seconds").replace("+00:00", "Z")
    told = {"act": move} if isinstance(move, str) else to_json(move)
    size = append_at(path, end.size, {"at": now, **told, "gives": gives})
    return Line(number=end.number, at=now, move=move, gives=gives), End(size, end.number + 1)
