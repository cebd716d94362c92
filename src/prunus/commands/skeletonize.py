"""`prunus skeletonize`: scans to labelled skeletons."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from prunus.commands.options import (
    BasePoint,
    Frame,
    FrameOfFile,
    Jobs,
    NoIsolate,
    ParamsFile,
    Points,
    Seed,
    UnitOfFile,
    Weights,
    check_use,
    network_in,
    parameters_in,
)
from prunus.errors import Status

if TYPE_CHECKING:
    from prunus.commands.progress import Waiting


def skeletonize(
    ctx: typer.Context,
    clouds: Annotated[list[Path], typer.Argument(help="Point clouds, bags, or folders of them.")],
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="Folder to write to. [default: prunus-out/NAME]"),
    ] = None,
    base: BasePoint = None,
    frame: FrameOfFile = Frame.AUTO,
    unit: UnitOfFile = None,
    points: Points = None,
    params: ParamsFile = None,
    seed: Seed = 0,
    weights: Weights = None,
    no_isolate: NoIsolate = False,
    no_report: Annotated[bool, typer.Option("--no-report", help="Write no report.html.")] = False,
    traits: Annotated[
        bool, typer.Option("--traits", help="Write traits of branches and tree, CSV and Parquet.")
    ] = False,
    json: Annotated[
        bool, typer.Option("--json", help="One line of JSON a tree on standard output.")
    ] = False,
    jobs: Jobs = 1,
) -> None:
    """Turn scans (clouds, ROS bags) into labelled skeletons.

    Reads PLY, PCD, XYZ, TXT, CSV, LAS, LAZ, NPY, NPZ. Writes skeleton.json, .swc and .ply,
    refined.json, report.html and params.toml for each tree.

    By hand: `prunus skeletonize tree.ply --base 1.40 0.90 1.42 -o out`

    A camera's frame: `prunus skeletonize tree.ply --frame optical`

    A topic of a bag: `prunus skeletonize row.mcap#/camera/points`

    For a script: `prunus skeletonize scans/ --jobs 4 --json > trees.jsonl`
    """
    from prunus.batch.run import Options, plan

    options = Options(
        base=base,
        frame=frame.value,
        unit=unit and unit.value,
        params=parameters_in(params, points, no_isolate),
        seed=seed,
        scorer=network_in(weights),
        report=not no_report,
        traits=traits,
    )
    check_use(options.params, weights)
    tasks, failed = plan(clouds, output)
    report_on(ctx.obj, tasks, failed, options, json, jobs)


def report_on(
    waiting: Waiting, tasks: list[Any], failed: list[Any], options: Any, as_json: bool, jobs: int
) -> None:
    """Run the tasks, say what came of each, and exit with 1 if any failed."""
    from prunus.batch.run import run
    from prunus.commands.progress import Teller

    teller = Teller(waiting, as_json)
    for record in failed:
        teller.tell(record)
    if len(tasks) == 1:
        waiting.doing(f"working on {tasks[0].path}")
    else:
        waiting.doing("trees", len(tasks))
    for record in run(tasks, options, jobs):
        teller.tell(record)
    teller.sum_up()
    if teller.failures:
        raise typer.Exit(Status.FAILED)
