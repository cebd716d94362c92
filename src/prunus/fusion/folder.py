"""From a rig's folder to one cloud file, and what is said of every view."""

from __future__ import annotations

from pathlib import Path

from prunus.errors import PrunusError
from prunus.files.safely import write_bytes
from prunus.fusion.fuse import Fused, Placed, fuse
from prunus.io.clouds.cloud_file import check_kind, write_cloud
from prunus.io.records import FusedFile, ViewFused
from prunus.io.rig import read_rig


def fuse_folder(folder: Path, output: Path, report: Path | None = None) -> Fused:
    """Fuse the views in a folder and write the cloud; with `report` the evidence as JSON.

    Raises PrunusError naming the file or the view, what was found and what was expected.
    """
    check_kind(output)
    views = read_rig(folder)
    try:
        fused = fuse(views)
    except PrunusError as error:
        raise PrunusError(f"{folder}: {error}") from error
    write_cloud(output, fused.xyz, fused.rgb)
    if report is not None:
        told = FusedFile(views=[_record(view) for view in fused.views])
        write_bytes(report, (told.model_dump_json(indent=1) + "\n").encode())
    return fused


def lines_of(fused: Fused) -> list[str]:
    """A table of the views for people: residuals in millimetres before and after."""
    wide = max(len("view"), *(len(view.name) for view in fused.views))
    head = f"{'view':{wide}}  points  flying  before   after  agree  moved  turned"
    units = f"{'':{wide}}                      mm      mm             mm     deg"
    return [head, units, *(_line(view, wide) for view in fused.views)]


def _line(view: Placed, wide: int) -> str:
    said = f"  left out: {view.refused}" if view.refused else ""
    return (
        f"{view.name:{wide}}  {view.points:6d}  {view.flying:6d}  {1000 * view.before:6.1f}  "
        f"{1000 * view.after:6.1f}  {view.agree:5.0%}  {1000 * view.moved:5.1f}  "
        f"{view.turned:6.2f}{said}"
    )


def _record(view: Placed) -> ViewFused:
    """What the report says of a view."""
    return ViewFused(
        name=view.name,
        rotation=view.pose.rotation.tolist(),
        translation=view.pose.translation.tolist(),
        points=view.points,
        flying=view.flying,
        before=_known(view.before),
        after=_known(view.after),
        agree=view.agree,
        moved=view.moved,
        turned=view.turned,
        refused=view.refused or None,
    )


def _known(value: float) -> float | None:
    return None if value != value else value
