"""Processes that work side by side: the one home of all pools.

Each worker has a pipe of its own and one item at a time. So when one is killed, exactly its item
is lost and all others are done. (The pools of the standard library lose all.) A worker ends with
the process that started it, whatever ends that.
"""

from __future__ import annotations

import atexit
import os
import pickle
import signal
import threading
import time
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass
from functools import partial
from multiprocessing import get_context, parent_process
from multiprocessing.connection import Connection, wait
from traceback import format_exc
from typing import Any, Generic, TypeVar

from prunus.errors import PrunusError
from prunus.processes.ending import end_on_signals

Item = TypeVar("Item")
Made = TypeVar("Made")

GRACE_S = 3.0
"""How long a worker that was told to end may clear away before it is killed."""


class WorkerError(PrunusError):
    """A worker ended in the midst of an item."""


@dataclass(frozen=True)
class Done(Generic[Made]):
    """What was made of the item of a number, or the exception that came of it instead."""

    number: int
    made: Made | None
    error: Exception | None


def in_order(function: Callable[[Item], Made], items: Sequence[Item], jobs: int) -> Iterator[Made]:
    """What a function makes of each item, in order, so many at a time.

    The first exception is raised here: WorkerError where a worker was killed.
    """
    if jobs == 1:
        yield from map(function, items)
        return
    early: dict[int, Any] = {}
    following = 0
    with closing(side_by_side(function, items, jobs)) as all_done:
        for done in all_done:
            if done.error is not None:
                raise done.error
            early[done.number] = done.made
            while following in early:
                yield early.pop(following)
                following += 1


def side_by_side(
    function: Callable[[Item], Made], items: Sequence[Item], jobs: int
) -> Generator[Done[Made]]:
    """What a function makes of each item, as it is done: every item once, whatever happens.

    All is done in other processes, also where only one at a time is asked for.
    """
    todo = iter(enumerate(items))
    crew = [_Worker(function) for _ in range(min(jobs, len(items)))]
    end = partial(_end, crew)
    atexit.register(end)
    try:
        idle = list(crew)
        while True:
            while idle and (following := next(todo, None)) is not None:
                failed = idle[-1].begin(*following)
                if failed is None:
                    idle.pop()
                else:
                    yield failed
            busy = {worker.pipe: worker for worker in crew if worker not in idle}
            if not busy:
                return
            for pipe in wait(list(busy)):
                worker = busy[pipe]  # type: ignore[index]
                idle.append(worker)
                yield worker.finish()
    finally:
        end()
        atexit.unregister(end)


class _Worker(Generic[Item, Made]):
    """A process that is started when there is something to do, and the number of its item."""

    def __init__(self, function: Callable[[Item], Made]) -> None:
        self.function = function
        self.process: Any = None
        self.number = -1

    def begin(self, number: int, item: Item) -> Done[Made] | None:
        """Give it an item; what came of it at once where no process can be started."""
        self.number = number
        try:
            if self.process is None or not self.process.is_alive():
                self.end(0.0)
                self._start()
            self.pipe.send(item)
        except OSError as error:
            self.end(0.0)
            text = f"no process could be started for it ({error.strerror or error})"
            return Done(number, None, PrunusError(text))
        return None

    def _start(self) -> None:
        context = get_context("spawn")
        self.pipe, theirs = context.Pipe()
        process = context.Process(target=_work, args=(theirs, self.function), daemon=True)
        with theirs, _no_ctrl_c():
            process.start()
        self.process = process

    def finish(self) -> Done[Made]:
        """What came of the item; waits for it."""
        try:
            made, error = self.pipe.recv()
        except (EOFError, OSError):
            self.process.join(GRACE_S)
            died = WorkerError(_how(self.process.exitcode))
            self.end(0.0)
            return Done(self.number, None, died)
        return Done(self.number, made, error)

    def end(self, patience: float) -> None:
        """Leave no process; one that goes on for longer than `patience`, seconds, is killed."""
        if self.process is not None:
            self.process.join(patience)
            self.process.kill()
            self.process.join()
            self.pipe.close()
        self.process = None


def _end(crew: list[_Worker[Any, Any]]) -> None:
    """Tell all to end, and see to it that they do."""
    running = [worker for worker in crew if worker.process is not None]
    for worker in running:
        worker.process.terminate()
    deadline = time.monotonic() + GRACE_S
    for worker in running:
        worker.end(max(0.0, deadline - time.monotonic()))


@contextmanager
def _no_ctrl_c() -> Iterator[None]:
    """Start processes that Ctrl-C does not reach: it reaches their parent, which ends them."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _work(pipe: Connection, function: Callable[[Any], Any]) -> None:
    """The life of a worker."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    end_on_signals()
    threading.Thread(target=_end_with_parent, daemon=True).start()
    with suppress(EOFError, OSError):
        while True:
            pipe.send(_outcome(function, pipe.recv()))


def _outcome(function: Callable[[Any], Any], item: Any) -> tuple[Any, Exception | None]:
    try:
        return function(item), None
    except Exception as error:  # whatever it is, it is for the parent to judge
        error.add_note(format_exc())
        return None, _portable(error)


def _portable(error: Exception) -> Exception:
    """The same exception, or its text where it does not survive the way to another process."""
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:  # libraries make exceptions that fail here in every way there is
        return RuntimeError(f"{type(error).__name__}: {error}")
    return error


def _end_with_parent() -> None:
    """End as soon as the parent is gone; by force where the work does not hear of it."""
    parent = parent_process()
    if parent is not None:
        parent.join()
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(GRACE_S)
        os._exit(1)


def _how(status: int | None) -> str:
    """How a worker ended, by the exit status of its process."""
    number = -(status or 0) if (status or 0) < 0 else (status or 0) - 128
    if number not in signal.valid_signals():
        return f"its worker ended in the midst of it (exit status {status})"
    if number == getattr(signal, "SIGKILL", None):
        return "its worker was killed, perhaps for want of memory; fewer --jobs need less"
    return f"its worker was ended by signal {number} ({signal.strsignal(number)})"
