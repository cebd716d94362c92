"""`prunus evaluate`: skeletons against gold standards."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from prunus.errors import Status

if TYPE_CHECKING:
    from prunus.commands.progress import Waiting


def evaluate(
    ctx: typer.Context,
    skeleton: Annotated[Path, typer.Argument(help="A skeleton, or a folder of them.")],
    gold: Annotated[Path, typer.Argument(help="Its gold standard, or a folder of them.")],
    json: Annotated[bool, typer.Option("--json", help="One line of JSON a pair.")] = False,
    csv: Annotated[Path | None, typer.Option(help="Write a table, one row a pair.")] = None,
) -> None:
    """Measure skeletons against gold standards: what was found, what is right.

    Reads skeletons of other tools too (PLY edges, SWC, OBJ lines, GraphML), for the geometry.

    One pair: `prunus evaluate out/skeleton.json gold.json`

    Two folders: `prunus evaluate out orchard --csv measures.csv`
    """
    from json import dumps

    from prunus.files.safely import write_bytes
    from prunus.io.tables import csv_bytes
    from prunus.lab.evaluate.pairs import compare, pairs_in, spread_lines, strangers

    waiting: Waiting = ctx.obj
    pairs = pairs_in(skeleton, gold)
    records = [compare(*pair) for pair in waiting.watch(pairs, "pairs", len(pairs))]
    if csv is not None:
        write_bytes(csv, csv_bytes(records))
    waiting.tell(map(dumps, records) if json else spread_lines(records))
    hints = strangers(pairs, records)
    for hint in hints:
        waiting.say(hint)
    if len(hints) == len(records):
        raise typer.Exit(Status.FAILED)
