"""One tree of the shelf as the server holds it: shared by all browsers that look at it."""

from __future__ import annotations

import threading
from collections.abc import Callable

from prunus.cuts import Plan
from prunus.editing import Act, State, branch_names
from prunus.editing.edits import Edits, edits
from prunus.errors import PrunusError, describe
from prunus.files.work_folder import PLAN
from prunus.frames.scan import Scan
from prunus.model import PointCloud, Skeleton
from prunus.session import Settings, Work, status_of
from prunus.studio.picture import Picture
from prunus.studio.planned import file_of, save, told_of_file
from prunus.studio.shelf import Item

Told = Callable[[], None]


class Tree:
    """A tree that is opened when somebody looks, and closed when nobody does any more."""

    def __init__(self, item: Item, settings: Settings) -> None:
        self.item = item
        self.settings = settings
        self.lock = threading.RLock()
        self.watchers: list[Told] = []
        self.opening = False
        self.cloud: PointCloud | None = None
        self.work: Work | None = None
        self.problem: str | None = None
        self.status = ""
        self.look_up()

    def look_up(self) -> None:
        """Look on the disk how far the work is."""
        try:
            self.status = status_of(self.item.folder)
        except PrunusError:
            self.status = "broken"

    def watch(self, told: Told) -> None:
        """Open the tree if it is not; `told` is called, from any thread, when it has changed."""
        with self.lock:
            self.watchers.append(told)
            if self.work is not None or self.opening:
                return
            self.opening, self.problem = True, None
        threading.Thread(target=self._open, daemon=True).start()

    def leave(self, told: Told) -> None:
        """Nobody is told any more; the last one to leave closes the tree."""
        with self.lock:
            if told in self.watchers:
                self.watchers.remove(told)
            self._close_if_alone()

    def close(self) -> None:
        """Let go of the file, whoever looks."""
        with self.lock:
            self.watchers.clear()
            self._close_if_alone()

    def do(self, act: Act) -> None:
        """An act on the work; raises Refused where it would break a rule."""
        with self.lock:
            self._opened().do(act)
        self._tell()

    def undo(self) -> bool:
        """Take the last act back; False where there is none."""
        with self.lock:
            done = self._opened().undo() is not None
        self._tell()
        return done

    def redo(self) -> bool:
        """Do again what was taken back; False where there is nothing."""
        with self.lock:
            done = self._opened().redo() is not None
        self._tell()
        return done

    def save_plan(self, plan: Plan) -> None:
        """Write the plan of the work as it stands; PrunusError where the tree is read-only."""
        with self.lock:
            work = self.own()
            save(work.folder / PLAN, file_of(plan, work))

    def told_of_plan(self, plan: Plan) -> str:
        """Whether a plan of the work as it stands was saved, in words."""
        with self.lock:
            work = self._opened()
            return told_of_file(work.folder / PLAN, file_of(plan, work))

    def own(self) -> Work:
        """The work, to be written to; PrunusError where somebody else has the tree open."""
        work = self._opened()
        if work.read_only is not None:
            raise PrunusError(f"the tree is open at {work.read_only}; here it is read-only")
        return work

    @property
    def state(self) -> State | None:
        """The work as it stands; None while the tree is being opened."""
        with self.lock:
            return None if self.work is None else self.work.state

    @property
    def read_only(self) -> str | None:
        """Who else has the tree open, if anybody has."""
        with self.lock:
            return None if self.work is None else self.work.read_only

    @property
    def notes(self) -> list[str]:
        """What a person should know of how the tree was read."""
        with self.lock:
            return [] if self.work is None else self.work.notes

    def picture(self) -> Picture | None:
        """What there is to draw; None before the file is read."""
        with self.lock:
            if self.work is None:
                return None if self.cloud is None else Picture(scan=self.cloud)
            return picture_of(self.work.state, self.work.machine)

    def edits(self) -> Edits | None:
        """What the person has changed of the machine's skeleton."""
        with self.lock:
            if self.work is None:
                return None
            return edits(self.work.machine, self.work.state.draft.numbered())

    def _open(self) -> None:
        """Read the file, show its points, then run the chain and replay what was done before."""
        try:
            work = Work.open(self.item.source, self.item.folder, self.settings, seen=self._seen)
            with self.lock:
                self.work = work
        except Exception as error:  # whatever it is, the other trees and browsers go on
            with self.lock:
                self.problem = describe(error)
        finally:
            with self.lock:
                self.opening = False
                self._close_if_alone()
        self._tell()

    def _seen(self, scan: Scan) -> None:
        with self.lock:
            self.cloud = scan.cloud
        self._tell()

    def _close_if_alone(self) -> None:
        if self.watchers or self.opening:
            return
        if self.work is not None:
            self.work.close()
        self.work = self.cloud = None

    def _opened(self) -> Work:
        if self.work is None:
            raise PrunusError(f"{self.item.name}: is not open yet")
        return self.work

    def _tell(self) -> None:
        self.look_up()
        with self.lock:
            watchers = list(self.watchers)
        for told in watchers:
            told()


def picture_of(state: State, machine: Skeleton) -> Picture:
    """The picture of a state of the work."""
    draft = state.draft
    return Picture(
        scan=state.scan,
        kind=state.kind,
        skeleton=draft.skeleton(),
        graph=state.result.graph,
        machine=machine,
        nodes=draft.nodes,
        names=branch_names(draft),
    )
