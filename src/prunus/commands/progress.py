"""What the command line says while it works: a bar on a terminal, plain lines in a pipe.

All of it goes to standard error; standard output holds results alone.
"""

from __future__ import annotations

import json
import logging
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, Progress, ProgressColumn, Task, TextColumn, TimeElapsedColumn
from rich.text import Text

from prunus.names import in_line

SOON_S = 1.5
"""A step is named once there was nothing to read for so long."""
AGAIN_S = 30.0
"""While it lasts, a word follows as often as this."""
TICK_S = 0.25
"""How often it is looked whether a word is due."""


class _Count(ProgressColumn):
    """`3 of 29`; nothing where the total is unknown."""

    def render(self, task: Task) -> Text:
        """The text of a task."""
        return Text("" if task.total is None else f"{task.completed:.0f} of {task.total:.0f}")


@dataclass(kw_only=True)
class Step:
    """What is being done since when, and how many of how many are done."""

    what: str
    total: int | None
    began: float
    done: int = 0

    def named(self) -> str:
        """The first that is said of it."""
        return self.what if self.total is None else f"{self.what}: {self.done} of {self.total}"

    def reminder(self, now: float) -> str:
        """What is said of it later."""
        still = "still " if self.total is None else ""
        return f"{still}{self.named()} ({now - self.began:.0f} s)"


class Waiting:
    """Tells a person what is being done, so that nobody looks at nothing for long.

    On a terminal there is a bar. Elsewhere a step is named where it takes over a second or two,
    with a word every half minute after it. What the library logs as a warning is said too.
    """

    def __init__(
        self, console: Console | None = None, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self.console = console or Console(stderr=True, highlight=False, emoji=False)
        self.clock = clock
        self.live = self.console.is_terminal and not self.console.is_dumb_terminal
        # Else rich would take standard output for the terminal, even where it is a file.
        self.bar = Progress(
            TextColumn("{task.description}"), BarColumn(), _Count(), TimeElapsedColumn(),
            console=self.console, transient=True, redirect_stdout=False, redirect_stderr=False,
        )  # fmt: skip
        self.lock = threading.RLock()
        self.ended = threading.Event()
        self.ears = _Ears(self)
        self.doing("loading prunus")

    def __enter__(self) -> Waiting:
        logging.getLogger("prunus").addHandler(self.ears)
        threading.Thread(target=self._tick_on, daemon=True).start()
        return self

    def __exit__(self, *_: object) -> None:
        logging.getLogger("prunus").removeHandler(self.ears)
        self.ended.set()
        self.rest()

    def doing(self, what: str, total: int | None = None, *, at_once: bool = False) -> None:
        """From now on this is done; `at_once` names it now, where it is known to take long."""
        with self.lock:
            self.step: Step | None = Step(what=what, total=total, began=self.clock())
            self.spoken: float | None = None
            for task in self.bar.task_ids:
                self.bar.remove_task(task)
            self.bar.add_task(what, total=total)
            if at_once and not self.live:
                self.say(self.step.named())

    def advance(self) -> None:
        """One more of the step is done."""
        with self.lock:
            if self.step is not None:
                self.step.done += 1
                self.bar.advance(self.bar.task_ids[0])

    def watch(self, items: Iterable[Any], name: str, total: int) -> Iterator[Any]:
        """Pass items on as they come, and count them under a name."""
        self.doing(name, total)
        for item in items:
            self.advance()
            yield item

    def rest(self) -> None:
        """Nothing is being waited for."""
        with self.lock:
            self.step = None
            self._clear()

    def say(self, text: str) -> None:
        """A line for the person, on standard error."""
        with self.lock:
            self.console.print(in_line(text), markup=False, soft_wrap=True)
            self.spoken = self.clock()

    def tell(self, lines: Iterable[str]) -> None:
        """Lines that were asked for, on standard output."""
        with self.lock:
            self._clear()
            for line in lines:
                sys.stdout.write(_printable(line) + "\n")
            sys.stdout.flush()
            self.spoken = self.clock()

    def _clear(self) -> None:
        if self.live:
            self.bar.stop()

    def tick(self) -> None:
        """Say what is due by now."""
        with self.lock:
            if self.step is None:
                return
            now = self.clock()
            silent = now - (self.step.began if self.spoken is None else self.spoken)
            if self.live:
                if silent >= SOON_S:
                    self.bar.start()
            elif self.spoken is None and silent >= SOON_S:
                self.say(self.step.named())
            elif silent >= AGAIN_S:
                self.say(self.step.reminder(now))

    def _tick_on(self) -> None:
        while not self.ended.wait(TICK_S):
            self.tick()


class _Ears(logging.Handler):
    """Has what the library warns of said by the command line."""

    def __init__(self, waiting: Waiting) -> None:
        super().__init__(logging.WARNING)
        self.waiting = waiting

    def emit(self, record: logging.LogRecord) -> None:
        """Say it."""
        self.waiting.say(record.getMessage())


def _printable(line: str) -> str:
    """The line with what standard output cannot show, as many letters in old encodings, escaped."""
    encoding = sys.stdout.encoding or "utf-8"
    return in_line(line).encode(encoding, "backslashreplace").decode(encoding)


class Teller:
    """Tells records of trees as they come, and at the end which failed and why."""

    def __init__(self, waiting: Waiting, as_json: bool) -> None:
        """`as_json`: one line of JSON a record on standard output, and nothing else there."""
        self.waiting = waiting
        self.as_json = as_json
        self.failures: list[str] = []
        self.done = 0

    def tell(self, record: dict[str, Any]) -> None:
        """What came of one tree."""
        self.waiting.advance()
        if self.as_json:
            self.waiting.tell([json.dumps(record)])
        if not record["ok"]:
            self.failures.append(record["error"])
            self.waiting.say(f"prunus: {record['error']}")
            return
        self.done += 1
        if not self.as_json:
            self.waiting.tell(lines_of(record))

    def sum_up(self) -> None:
        """Which of several failed."""
        count = self.done + len(self.failures)
        if self.failures and count > 1:
            self.waiting.say(f"{len(self.failures)} of {count} failed:")
            for error in self.failures:
                self.waiting.say(f"  {error}")


def lines_of(record: dict[str, Any]) -> list[str]:
    """What a person wants to know of a tree."""
    edges = ", ".join(f"{word.replace('_', ' ')} {n}" for word, n in record["labels"].items())
    lines = [
        f"{record['file']}: leaders {record['leaders']}, side branches "
        f"{record['side_branches']} (edges: {edges}) in {record['cpu_s']['total']:.2f} s of CPU"
    ]
    lines += [f"  {said}" for said in dict.fromkeys([*record["warnings"], *record["review"]])]
    if record["review"]:
        lines.append("  a person should look at it before a machine acts on it")
    return [*lines, f"  written to {Path(record['skeleton']).parent}"]
