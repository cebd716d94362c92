"""What the command line says while it works: a bar on a terminal, plain lines in a pipe."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from types import TracebackType
from typing import Any

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn


def progress_bar(console: Console | None = None) -> Progress:
    """A bar that counts and tells the time on a terminal, and nothing in a pipe."""
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        console=console or Console(stderr=True, highlight=False),
        transient=True,
        disable=not sys.stderr.isatty(),
    )


def bar_of(bar: Progress) -> Callable[[Iterable[Any], str, int], Iterator[Any]]:
    """A function that passes items on as they come and counts them, under a name, on the bar."""

    def watch(items: Iterable[Any], name: str, total: int) -> Iterator[Any]:
        work = bar.add_task(name, total=total)
        for item in items:
            bar.advance(work)
            yield item

    return watch


class Teller:
    """Tells records as they come, and at the end which failed and why."""

    def __init__(self, total: int, as_json: bool) -> None:
        """`as_json`: one line of JSON a record on standard output, and nothing else there."""
        self.as_json = as_json
        self.failures: list[dict[str, Any]] = []
        self.done = 0
        self.console = Console(stderr=True, highlight=False)
        self.bar = progress_bar(self.console)
        self.work = self.bar.add_task("trees", total=total)

    def __enter__(self) -> Teller:
        self.bar.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.bar.stop()
        if kind is None and self.failures and self.done + len(self.failures) > 1:
            count = self.done + len(self.failures)
            self.say(f"{len(self.failures)} of {count} failed:")
            for record in self.failures:
                self.say(f"  {record['error']}")

    def say(self, text: str) -> None:
        """A line for the person, on standard error."""
        self.console.print(text, markup=False, soft_wrap=True)

    def tell(self, record: dict[str, Any]) -> None:
        """What came of one tree."""
        self.bar.advance(self.work)
        if self.as_json:
            sys.stdout.write(json.dumps(record) + "\n")
            sys.stdout.flush()
        if record["ok"]:
            self.done += 1
            if not self.as_json:
                self._tell_tree(record)
        else:
            self.failures.append(record)
            self.say(f"prunus: {record['error']}")

    def _tell_tree(self, record: dict[str, Any]) -> None:
        """What a person wants to know of a tree, on standard output."""
        edges = ", ".join(f"{word.replace('_', ' ')} {n}" for word, n in record["labels"].items())
        typer.echo(
            f"{record['file']}: leaders {record['leaders']}, side branches "
            f"{record['side_branches']} (edges: {edges}) in {record['cpu_s']['total']:.2f} s of CPU"
        )
        for warning in dict.fromkeys([*record["warnings"], *record["review"]]):
            typer.echo(f"  {warning}")
        if record["review"]:
            typer.echo("  a person should look at it before a machine acts on it")
        typer.echo(f"  written to {Path(record['skeleton']).parent}")
