"""From one kind of file to another."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from prunus.errors import PrunusError
from prunus.io.clouds import read_cloud, write_cloud
from prunus.io.export import write_graphml, write_ply, write_swc
from prunus.io.skeletons import read_record, read_skeleton, write_skeleton
from prunus.model import Skeleton

SKELETON_WRITERS: dict[str, Callable[[Path, Skeleton], None]] = {
    ".json": write_skeleton,
    ".swc": write_swc,
    ".ply": write_ply,
    ".graphml": write_graphml,
}


def convert_file(source: Path, target: Path, unit: str | None = None) -> None:
    """Convert a skeleton or a cloud; PrunusError where source or target is of no such kind."""
    kind, wanted = source.suffix.lower(), target.suffix.lower()
    if kind not in (".json", ".swc"):
        cloud = read_cloud(source, unit)
        write_cloud(target, cloud.xyz, cloud.rgb)
        return
    if wanted not in SKELETON_WRITERS:
        raise PrunusError(
            f"{target}: skeletons are not written as {target.suffix!r}; "
            f"expected one of {' '.join(SKELETON_WRITERS)}"
        )
    if kind == wanted == ".json":
        skeleton, record = read_record(source)
        evidence = record.model_dump(
            include={"score", "input", "params", "seed", "version_of_prunus"}
        )
        write_skeleton(target, skeleton, **evidence)
        return
    SKELETON_WRITERS[wanted](target, read_skeleton(source))
