"""`prunus cuts`: a plan of pruning cuts."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from prunus.commands.options import (
    BasePoint,
    Frame,
    FrameOfFile,
    NoIsolate,
    ParamsFile,
    Points,
    Scans,
    Seed,
    UnitOfFile,
    Weights,
    check_use,
    network_in,
    parameters_in,
)
from prunus.errors import blaming_the_command

if TYPE_CHECKING:
    from prunus.commands.progress import Waiting


def cuts(
    ctx: typer.Context,
    source: Annotated[Path, typer.Argument(help="A skeleton (.json, .swc) or a point cloud.")],
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="Plan to write, as .json.")
    ] = None,
    rules: Annotated[
        Path | None,
        typer.Option(
            exists=True, dir_okay=False, help="TOML; what it does not name is as `prunus rules`."
        ),
    ] = None,
    base: BasePoint = None,
    frame: FrameOfFile = Frame.AUTO,
    unit: UnitOfFile = None,
    points: Points = None,
    params: ParamsFile = None,
    seed: Seed = 0,
    weights: Weights = None,
    no_isolate: NoIsolate = False,
    scans: Scans = None,
    json: Annotated[bool, typer.Option("--json", help="The plan as one line of JSON.")] = False,
) -> None:
    """Plan pruning cuts by rules: where the blade goes, and what is unsure.

    From a scan: `prunus cuts tree.ply -o plan.json`

    From a skeleton: `prunus cuts out/skeleton.json --rules mine.toml`

    docs/cuts.md has the rules. A cut with a `look:` is for a person to look at before it is made.
    """
    from prunus.cuts import CutRules, shipped_rules
    from prunus.cuts.plan_file import Source, cut_file, lines_of
    from prunus.io.skeletons.plans import write_plan

    waiting: Waiting = ctx.obj
    wanted = Source(
        path=source,
        base=base,
        frame=frame.value,
        unit=unit and unit.value,
        scans=scans,
        params=parameters_in(params, points, no_isolate),
        seed=seed,
        scorer=network_in(weights),
    )
    check_use(wanted.params, weights)
    with blaming_the_command():
        by = shipped_rules() if rules is None else CutRules.from_toml(rules)
        wanted.check()
    waiting.doing(f"planning cuts on {source}")
    plan = cut_file(wanted, by)
    if output is not None:
        write_plan(output, plan)
    waiting.tell([plan.model_dump_json()] if json else lines_of(plan))
