"""`prunus isolate`: one tree out of a raw scan."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from prunus.commands.options import (
    BasePoint,
    Frame,
    FrameOfFile,
    ParamsFile,
    Points,
    Seed,
    UnitOfFile,
    parameters_in,
)
from prunus.errors import OptionError

if TYPE_CHECKING:
    from prunus.commands.progress import Waiting


def isolate(
    ctx: typer.Context,
    raw: Annotated[Path, typer.Argument(help="A raw scan: ground, posts, wires, neighbours.")],
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="The tree's own points (PLY, XYZ, NPZ).")
    ] = None,
    base: BasePoint = None,
    list_: Annotated[bool, typer.Option("--list", help="Only list the trees in view.")] = False,
    every: Annotated[bool, typer.Option("--all", help="Write each tree in view.")] = False,
    classes: Annotated[
        bool, typer.Option("--classes", help="Write all points, with what each is (PLY).")
    ] = False,
    frame: FrameOfFile = Frame.AUTO,
    unit: UnitOfFile = None,
    points: Points = None,
    params: ParamsFile = None,
    seed: Seed = 0,
) -> None:
    """Take one tree out of a raw scan; the scan itself stays as it is.

    What is there: `prunus isolate raw.ply --list`

    One of them: `prunus isolate raw.ply -o tree.ply --at 0.35 1.10 1.45`

    What each point was taken for: `prunus isolate raw.ply -o c.ply --classes`
    """
    waiting: Waiting = ctx.obj
    if output is None and not list_:
        raise OptionError("nowhere to write to: say -o TREE.ply, or --list")
    if base is not None and (every or list_):
        raise OptionError("--at: of one tree; expected neither --all nor --list beside it")
    from prunus.isolation import Opened, check_output, list_trees, write_all, write_tree

    settings = parameters_in(params, points, no_isolate=False)
    if settings.isolation.isolate == "never":  # as the paper's have it, of no use here
        settings = settings.changed("isolation", isolate="auto")
    if output is not None:
        check_output(output, classes)
    waiting.doing(f"looking at {raw}")
    opened = Opened.of(raw, frame.value, unit and unit.value, seed, base, settings)
    if output is None or list_:
        lines = list_trees(opened)
    elif every:
        lines = write_all(opened, output, classes)
    else:
        lines = write_tree(opened, output, classes)
    waiting.tell(lines)
