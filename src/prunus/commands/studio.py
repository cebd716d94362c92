"""`prunus studio`: the page to correct trees on."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from prunus.commands.options import (
    Frame,
    FrameOfFile,
    NoIsolate,
    ParamsFile,
    Points,
    Scans,
    Seed,
    UnitOfFile,
    parameters_in,
)

if TYPE_CHECKING:
    from prunus.commands.progress import Waiting


def studio(
    ctx: typer.Context,
    path: Annotated[Path, typer.Argument(help="A scan, a skeleton.json, or a folder of them.")],
    output: Annotated[
        Path, typer.Option("-o", "--output", help="Folder in which the work is kept.")
    ] = Path("prunus-studio"),
    port: Annotated[
        int, typer.Option(min=0, max=65535, help="The next free one is taken; 0: any.")
    ] = 8080,
    host: Annotated[
        str, typer.Option(help="Address to listen on; other machines need the token then.")
    ] = "127.0.0.1",
    token: Annotated[
        str | None, typer.Option(help="Asked for on the page. [default: random, off this machine]")
    ] = None,
    no_open: Annotated[bool, typer.Option("--no-open", help="Open no browser.")] = False,
    frame: FrameOfFile = Frame.AUTO,
    unit: UnitOfFile = None,
    points: Points = None,
    params: ParamsFile = None,
    seed: Seed = 0,
    no_isolate: NoIsolate = False,
    scans: Scans = None,
) -> None:
    """Look at trees, clean, correct and label them, on a page in the browser.

    A folder of scans: `prunus studio scans/ -o work`

    On another machine, here by `ssh -t -L 8080:localhost:8080 there`: `prunus studio scans/
    --no-open`
    """
    waiting: Waiting = ctx.obj
    waiting.doing(f"opening {path}")
    from prunus.session import Settings
    from prunus.studio.start import open_studio

    settings = Settings(
        frame=frame.value, unit=unit and unit.value, seed=seed,
        params=parameters_in(params, points, no_isolate), scans=scans,
    )  # fmt: skip

    def say(line: str) -> None:
        waiting.rest()
        waiting.tell([line])

    open_studio(
        path, output, settings, host=host, port=port, token=token, browser=not no_open, say=say
    )
