"""glTF 2.0: a tube for each branch, as a mesh of its name in the material of its label."""

from __future__ import annotations

import base64
import json
import struct
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prunus.files.safely import write_bytes
from prunus.io.meshes.mesh import Tube, tubes
from prunus.io.skeletons.export import COLOURS
from prunus.model import FRAMES, Floats, Label, Skeleton

Z_UP_TO_Y_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
"""From the house frame to that of glTF."""

KINDS = {"f": (5126, "VEC3"), "u": (5125, "SCALAR")}
"""Component type and type of glTF, of points and of indices."""


def write_gltf(
    path: str | Path, skeleton: Skeleton, named: Mapping[int, str] | None = None
) -> None:
    """Write .glb (binary) or .gltf (text, the buffer in it), by the ending.

    The tree stands upright in a viewer: the root node turns the frame of the file to that of glTF,
    Y up, and holds the place of the base in double precision. `named`: see `tubes`.
    """
    path = Path(path)
    found = tubes(skeleton, named)
    arrays = [array for tube in found for array in _arrays(tube, skeleton.xyz[0])]
    buffer = b"".join(array.tobytes() for array in arrays)
    document = _document(found, arrays, _standing(skeleton))
    document["buffers"] = [{"byteLength": len(buffer)}]
    if path.suffix.lower() == ".gltf":
        held = base64.b64encode(buffer).decode()
        document["buffers"][0]["uri"] = f"data:application/octet-stream;base64,{held}"
        write_bytes(path, json.dumps(document).encode())
    else:
        write_bytes(path, _binary(document, buffer))


def _arrays(tube: Tube, base: Floats) -> list[NDArray[Any]]:
    """Vertices, from the base, and normals (V, 3), and the corners of the faces (3F,)."""
    vertices = (tube.vertices - base).astype("<f4")
    return [vertices, tube.normals.astype("<f4"), tube.faces.astype("<u4").reshape(-1)]


def _standing(skeleton: Skeleton) -> list[float]:
    """The matrix of the root node, column by column.

    Of the named frames, that in which the wood grows upward.
    """
    growth = skeleton.edge_vectors.sum(axis=0)
    to_house = max(FRAMES.values(), key=lambda turn: float((turn @ growth)[2]))
    matrix = np.eye(4)
    matrix[:3, :3] = Z_UP_TO_Y_UP @ to_house
    matrix[:3, 3] = matrix[:3, :3] @ skeleton.xyz[0]
    return [float(value) for value in matrix.T.reshape(-1)]


def _document(
    found: list[Tube], arrays: list[NDArray[Any]], standing: list[float]
) -> dict[str, Any]:
    ends = np.cumsum([array.nbytes for array in arrays]).tolist()
    return {
        "asset": {"version": "2.0", "generator": "prunus"},
        "scene": 0,
        "scenes": [{"nodes": [len(found)]}],
        "nodes": [
            *({"name": tube.name, "mesh": mesh} for mesh, tube in enumerate(found)),
            {"name": "tree", "matrix": standing, "children": list(range(len(found)))},
        ],
        "meshes": [_mesh(tube, 3 * mesh) for mesh, tube in enumerate(found)],
        "materials": [_material(label) for label in Label],
        "accessors": [_accessor(view, array) for view, array in enumerate(arrays)],
        "bufferViews": [
            {"buffer": 0, "byteOffset": end - array.nbytes, "byteLength": array.nbytes}
            for end, array in zip(ends, arrays, strict=True)
        ],
    }


def _mesh(tube: Tube, first: int) -> dict[str, Any]:
    primitive = {
        "attributes": {"POSITION": first, "NORMAL": first + 1},
        "indices": first + 2,
        "material": int(tube.label),
    }
    return {"name": tube.name, "primitives": [primitive]}


def _accessor(view: int, array: NDArray[Any]) -> dict[str, Any]:
    component, kind = KINDS[array.dtype.kind]
    about = {"bufferView": view, "componentType": component, "type": kind, "count": len(array)}
    if kind == "SCALAR":
        return about
    return about | {"min": array.min(axis=0).tolist(), "max": array.max(axis=0).tolist()}


def _material(label: Label) -> dict[str, Any]:
    """The colour of a label, from sRGB to what is in proportion to the light.

    The black of the trunk is made a little lighter: black shows no form.
    """
    values = np.array(COLOURS[label]) / 255
    light = np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)
    colour = [*np.maximum(light, 0.02).tolist(), 1.0]
    surface = {"baseColorFactor": colour, "metallicFactor": 0.0, "roughnessFactor": 0.8}
    return {"name": label.word, "pbrMetallicRoughness": surface}


def _binary(document: dict[str, Any], buffer: bytes) -> bytes:
    """The container .glb: a header, then two chunks, each filled up to four bytes."""
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    buffer += b"\0" * (-len(buffer) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text
    chunks += struct.pack("<I4s", len(buffer), b"BIN\0") + buffer
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks
