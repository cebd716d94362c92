"""`prunus fuse`: the views of a rig to one cloud."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from prunus.commands.progress import Waiting


def fuse(
    ctx: typer.Context,
    rig: Annotated[Path, typer.Argument(help="Folder with rig.json, or with *_cloud.ply.")],
    output: Annotated[Path, typer.Option("-o", "--output", help="Cloud to write, as .ply.")],
    report: Annotated[
        Path | None, typer.Option(help="Write refined poses and residuals as JSON.")
    ] = None,
) -> None:
    """Fuse depth images or partial clouds of a rig to one cloud.

    Refines their poses together. docs/fuse.md describes rig.json. A view that does not fit the
    others is left out, and said.

    A rig to try it on: `prunus simulate -n 1 -o rig --views`

    Its views: `prunus fuse rig/tree_000000 -o raw.ply`
    """
    from prunus.fusion.folder import fuse_folder, lines_of

    waiting: Waiting = ctx.obj
    waiting.doing(f"fusing the views in {rig}")
    fused = fuse_folder(rig, output, report)
    waiting.tell([*lines_of(fused), f"{len(fused.xyz)} points written to {output}"])
