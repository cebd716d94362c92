"""`prunus experiment`: the paper's result section."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from prunus.commands.options import CORES, SCANS, Jobs, OrchardKind, OutputFolder, Scans, Seed
from prunus.errors import blaming_the_command

if TYPE_CHECKING:
    from prunus.commands.progress import Waiting


def experiment(
    ctx: typer.Context,
    output: OutputFolder,
    trees: Annotated[int, typer.Option(min=1, help="How many trees.")] = 29,
    draws: Annotated[int, typer.Option(min=1, help="Draws of 50 000 points a tree.")] = 3,
    scan: Annotated[OrchardKind, typer.Option(help=f"{SCANS}.")] = OrchardKind.HARD,
    seed: Seed = 0,
    gold: Annotated[
        Path | None,
        typer.Option(
            exists=True,
            file_okay=False,
            help="Your own trees in place of simulated ones: the studio's work folder.",
        ),
    ] = None,
    scans: Scans = None,
    ablation: Annotated[
        bool, typer.Option("--ablation", help="Also what each part brings, one at a time.")
    ] = False,
    jobs: Jobs = CORES,
) -> None:
    """Run the paper's result section on simulated trees or your own.

    Writes tables, figures, a page. Stopped half way, the same command goes on where it was.

    A quick look: `prunus experiment -o out --trees 6 --draws 1`

    On trees corrected in the studio: `prunus experiment --gold prunus-studio -o out`
    """
    from prunus.lab.experiment.results import Orchard, experiment, lines_of

    waiting: Waiting = ctx.obj
    with blaming_the_command():
        if gold is None:
            orchard = Orchard.simulated(trees, scan.value, seed)
        else:
            orchard = Orchard.corrected(gold, scans)
    results = experiment(output, orchard, draws, ablation, jobs, waiting.watch)
    waiting.tell([*lines_of(results), "", f"written to {output / 'index.html'}"])
