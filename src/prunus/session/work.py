"""One tree being corrected: the one place with a state, and the files in its work folder.

journal.jsonl    the acts (see `journal`)
graph.npz        what the machine made of the scan, which the acts name (see `graphs`)
skeleton.json    what the machine found, after `Rebuild` on the points left
corrected.json   what a person made of it; there as long as an act stands
mask.ply         what each point of the scan is, once points were marked
lock.json        who has the tree open
"""

from __future__ import annotations

import json
import threading
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import Any, Literal, Self

from prunus import __version__
from prunus.editing.acts import Act, from_json, to_json
from prunus.editing.state import State, apply, clear
from prunus.errors import PrunusError
from prunus.files.safely import remove
from prunus.files.work_folder import CORRECTED, JOURNAL, MASK, SKELETON
from prunus.frames.scan import Scan
from prunus.io.clouds.classes import write_classes
from prunus.io.skeletons.skeleton_file import write_skeleton
from prunus.model import Skeleton
from prunus.result import Result
from prunus.session import journal as book
from prunus.session import lock
from prunus.session.graphs import Graphs
from prunus.session.history import OTHER, History, gives
from prunus.session.journal import End, Head, Journal
from prunus.session.sources import (
    Kept,
    Machine,
    Settings,
    run,
    source_from,
    superpoints_digest,
    unseen,
)
from prunus.session.timeline import Move, Timeline


class Work:
    """A tree that is open; see `Work.open`.

    `scan` is the input and how it was read, `base` the one given to the chain; `notes` what a
    person should know of it; `read_only` who else has it open, None where it may be changed.
    """

    def __init__(self, folder: Path, machine: Machine, history: History, notes: list[str]) -> None:
        self.folder = folder
        self.scan = machine.scan
        self.settings = machine.settings
        self.base = machine.base
        self.notes = notes
        self.read_only: str | None = None
        self._history = history
        self._end: End | None = None
        self._written: dict[str, object] = {}
        self._one_at_a_time = threading.RLock()

    @classmethod
    def open(
        cls,
        source: str | Path,
        folder: str | Path,
        settings: Settings | None = None,
        *,
        read_only_if_locked: bool = True,
        seen: Callable[[Scan], None] = unseen,
    ) -> Work:
        """Open a cloud, or a `skeleton.json` with its cloud, with all that was done to it before.

        `seen` is given the scan once it is read, before the chain runs.
        Where a journal is in the folder, frame, unit, parameters and seed are its own. Raises
        PrunusError where the input cannot be read, the chain finds no tree in it, the journal is
        corrupt or was made on something else, or (unless reading will do) others have it open.
        """
        folder = Path(folder)
        holder = lock.acquire(folder)
        if holder is not None and not read_only_if_locked:
            raise PrunusError(f"{folder}: is open already, by {holder.told}")
        try:
            return cls._opened(Path(source), folder, settings or Settings(), holder, seen)
        except BaseException:
            if holder is None:
                lock.release(folder)
            raise

    @classmethod
    def _opened(
        cls,
        source: Path,
        folder: Path,
        settings: Settings,
        holder: lock.Holder | None,
        seen: Callable[[Scan], None],
    ) -> Work:
        path = folder / JOURNAL
        journal = book.read_journal(path)
        begun = journal if journal is not None and journal.lines else None
        head = begun.head if begun else None
        found = source_from(source, settings)
        graphs = Graphs(folder)
        machine = run(found, head, seen, _kept(graphs, head))
        lines = begun.lines if begun else ()
        history = History(State.of(machine.result), Timeline.of(lines), graphs)
        replayed = _replayed(path, begun, history, graphs) if begun else []
        notes = [*machine.notes, *graphs.notes, *replayed]
        work = cls(folder, machine, history, notes)
        if holder is not None:
            work.read_only = holder.told
            return work
        if begun:
            work._end = book.resume(path, begun)
        else:
            graphs.forget()
            work._end = book.begin(path, _head(machine))
        work._save()
        return work

    @property
    def state(self) -> State:
        """The tree as it is now."""
        return self._history.state

    @property
    def acts(self) -> list[Act]:
        """All acts; from `position` on those that were undone."""
        return self._history.timeline.acts

    @property
    def position(self) -> int:
        """How many acts stand."""
        return self._history.timeline.position

    @property
    def machine(self) -> Skeleton:
        """What the machine found on the superpoints of the present graph, house frame."""
        return self.state.result.in_house

    def do(self, act: Act) -> State:
        """Do an act and write it down; the state after it.

        Raises Refused, with what could be done instead, where the act would leave no legal tree,
        and PrunusError where it names what is not there, or the tree is read-only: nothing is done
        then. PrunusError also where a file cannot be written.
        """
        with self._one_at_a_time:
            self._require_own()
            act = from_json(json.loads(json.dumps(to_json(act))))
            state = apply(self.state, act)
            return self._write(clear(self.state, act), state)

    def undo(self) -> State | None:
        """Undo the last act that stands; None where there is none."""
        return self._go("undo", -1)

    def redo(self) -> State | None:
        """Do again what was undone last; None where there is nothing."""
        return self._go("redo", 1)

    def close(self) -> None:
        """Let others have the tree."""
        with self._one_at_a_time:
            if self._end is not None:
                lock.release(self.folder)
            self._end = None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, _: TracebackType | None
    ) -> None:
        self.close()

    def _require_own(self) -> End:
        if self.read_only is not None:
            raise PrunusError(f"{self.folder}: is open by {self.read_only}; here it is read-only")
        if self._end is None:
            raise PrunusError(f"{self.folder}: was closed; open it again")
        return self._end

    def _go(self, move: Literal["undo", "redo"], step: int) -> State | None:
        with self._one_at_a_time:
            self._require_own()
            if not self._history.timeline.can(move):
                return None
            return self._write(move, self._history.at(self.position + step))

    def _write(self, move: Move, state: State) -> State:
        """Write a line, then the files that follow from what it gave."""
        path, end = self.folder / JOURNAL, self._require_own()
        line, self._end = book.append(path, end, move, gives(move, state))
        self._history.add(line, state)
        self._save()
        return state

    def _save(self) -> None:
        """Write what the files do not hold yet."""
        state = self.state
        self._history.keep()
        if self._is_new(SKELETON, state.result):
            self._write_skeleton(SKELETON, state.result.skeleton, score=state.result.score)
        if self._is_new(CORRECTED, state.draft if self.position else None):
            if self.position:
                skeleton = state.draft.skeleton().moved(state.scan.to_input)
                self._write_skeleton(CORRECTED, skeleton)
            else:
                remove(self.folder / CORRECTED)
        if self._is_new(MASK, state.kind if state.marked else None):
            if state.marked:
                write_classes(self.folder / MASK, self.scan.file, state.kind)
            else:
                remove(self.folder / MASK)

    def _is_new(self, name: str, value: object) -> bool:
        """Whether a file does not come from this value yet; the next time it will."""
        new = name not in self._written or self._written[name] is not value
        self._written[name] = value
        return new

    def _write_skeleton(self, name: str, skeleton: Skeleton, **more: Any) -> None:
        result = self.state.result
        write_skeleton(
            self.folder / name,
            skeleton,
            input=self.scan.record,
            params=result.params.model_dump(),
            seed=result.seed,
            version_of_prunus=__version__,
            **more,
        )


def _head(machine: Machine) -> Head:
    """The first line of a new journal."""
    told = {
        "input": machine.scan.record,
        "params": machine.settings.params.model_dump(),
        "seed": machine.settings.seed,
        "frame": machine.settings.frame,
        "unit": machine.settings.unit,
        "base": machine.base,
        "superpoints": superpoints_digest(machine.result),
        "gives": gives("machine", State.of(machine.result)),
        "version_of_prunus": __version__,
    }
    return Head.model_validate(told)


def _kept(graphs: Graphs, head: Head | None) -> Kept:
    """Finds what a journal was begun on."""

    def kept(scan: Scan, settings: Settings) -> tuple[Scan, Result] | None:
        return graphs.first(scan, settings.params, settings.seed, fits)

    def fits(result: Result) -> bool:
        machine = gives("machine", State.of(result))
        return head is not None and (superpoints_digest(result), machine) == (
            head.superpoints,
            head.gives,
        )

    return kept


def _replayed(path: Path, journal: Journal, history: History, graphs: Graphs) -> list[str]:
    """Do all acts of a journal; what is to be said of them."""
    first = history.at(0)
    if superpoints_digest(first.result) != journal.head.superpoints:
        version = journal.head.version_of_prunus
        raise PrunusError(
            f"{path}:1: was made on other superpoints, by prunus {version} (this is "
            f"{__version__}); {'; '.join([OTHER, *graphs.notes])}"
        )
    notes = history.replay(path)
    if gives("machine", first) != journal.head.gives:
        notes.insert(0, f"{path}: the machine's skeleton is another than when it was begun")
    return notes
