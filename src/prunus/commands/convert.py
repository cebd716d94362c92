"""`prunus convert`: skeletons and clouds to what others read."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from prunus.commands.options import UnitOfFile

if TYPE_CHECKING:
    from prunus.commands.progress import Waiting


def convert(
    ctx: typer.Context,
    source: Annotated[Path, typer.Argument(help="A skeleton (.json, .swc) or a point cloud.")],
    target: Annotated[Path, typer.Argument(help="What to write; the ending says which kind.")],
    unit: UnitOfFile = None,
    cloud: Annotated[
        Path | None, typer.Option(help="The cloud, to go into a bag (.mcap) with the tree.")
    ] = None,
    cuts: Annotated[
        Path | None, typer.Option(help="Its plan (see `prunus cuts`), to go into the bag as poses.")
    ] = None,
) -> None:
    """Convert skeletons and clouds to what others read.

    Skeletons: .json .swc .ply .dxf .graphml .glb .gltf .obj .mtg .cylinders.csv .treeqsm.csv
    .txt (raycloudtools) .mcap (ROS 2). Clouds: .ply .xyz .txt .csv .npy .npz. What a kind of file
    cannot hold is said.

    For CloudCompare, as coloured lines: `prunus convert out/refined.json tree.dxf`

    For Blender, thick as it is: `prunus convert out/refined.json tree.glb`

    For RViz or Foxglove: `prunus convert out/refined.json tree.mcap`

    A cloud for another tool: `prunus convert tree.laz tree.xyz`
    """
    from prunus.io.convert import convert_file

    waiting: Waiting = ctx.obj
    waiting.doing(f"converting {source}")
    for note in convert_file(source, target, unit and unit.value, cloud, cuts):
        waiting.say(f"{target}: {note}")
