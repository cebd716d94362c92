"""Wavefront OBJ: a tube for each branch, as an object of its name in the material of its label."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from prunus.files.safely import write_bytes
from prunus.io.meshes.mesh import tubes
from prunus.io.skeletons.export import COLOURS
from prunus.model import Label, Skeleton


def write_obj(path: str | Path, skeleton: Skeleton, named: Mapping[int, str] | None = None) -> None:
    """Write the tubes, and beside them the materials with the colours of the labels (.mtl).

    `named`: see `tubes`.
    """
    path = Path(path)
    library = path.with_suffix(".mtl")
    lines = [
        "# prunus skeleton; unit: metre; frame: that of the input file",
        f"mtllib {library.name}",
    ]
    count = 1
    for tube in tubes(skeleton, named):
        lines += [f"o {tube.name.replace(' ', '_')}", f"usemtl {tube.label.word}", "s 1"]
        lines += [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in tube.vertices.tolist()]
        lines += [f"f {a} {b} {c}" for a, b, c in (tube.faces + count).tolist()]
        count += len(tube.vertices)
    write_bytes(path, ("\n".join(lines) + "\n").encode())
    write_bytes(library, "".join(_material(label) for label in Label).encode())


def _material(label: Label) -> str:
    red, green, blue = (value / 255 for value in COLOURS[label])
    return f"newmtl {label.word}\nKd {red:.4f} {green:.4f} {blue:.4f}\nillum 1\n\n"
