"""`prunus simulate`: an orchard and its scans."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from prunus.commands.options import CORES, SCANS, Jobs, OutputFolder, ScanKind
from prunus.errors import OptionError

if TYPE_CHECKING:
    from prunus.commands.progress import Waiting


def simulate(
    ctx: typer.Context,
    output: OutputFolder,
    trees: Annotated[int, typer.Option("-n", "--trees", min=1, help="How many trees.")] = 30,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the first; the next has the next.")] = 0,
    scan: Annotated[
        ScanKind, typer.Option(help=f"{SCANS}; any: of any tree, scanner and surroundings.")
    ] = ScanKind.HARD,
    views: Annotated[bool, typer.Option("--views", help="Write the depth images too.")] = False,
    jobs: Jobs = CORES,
) -> None:
    """Grow an orchard and scan it: clouds, the truth of each point, skeletons.

    Thirty trees to learn from or to judge by: `prunus simulate -n 30 -o orchard`
    """
    from functools import partial

    from prunus.lab.simulate import simulate_scan
    from prunus.lab.simulate.orchard import simulate_orchard
    from prunus.lab.simulate.wide.scan import simulate_wide

    if views and scan == ScanKind.ANY:
        raise OptionError("--views: only of the rig; expected --scan ordinary, hard or clean")
    setting: Any = scan.value
    make = simulate_wide if scan == ScanKind.ANY else partial(simulate_scan, setting=setting)
    waiting: Waiting = ctx.obj
    made = simulate_orchard(output, range(seed, seed + trees), make, views, min(jobs, trees))
    for _ in waiting.watch(made, "trees", trees):
        pass
    waiting.tell([f"{trees} trees written to {output}"])
