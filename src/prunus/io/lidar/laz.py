"""The chunks of a LAZ, checked before they are unpacked.

lazrs allocates what a file says before it looks whether it is there, and what it cannot allocate
ends the process: no exception tells.
"""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np

from prunus.errors import PrunusError

LAYERS = {10: 9, 11: 1, 12: 2, 13: 1}
"""Layers of an item of LAS 1.4, by its type: point, colours, colours and near infrared, wave."""
EXTRA_BYTES = 14
"""The type of further bytes, a layer each."""


def check_chunks(content: bytes, header: Any, path: Path) -> None:
    """That the chunks of a LAZ, and the layers of each, are as long as the file says.

    PrunusError otherwise. `header` is laspy's.
    """
    import lazrs

    begin = int(header.offset_to_point_data)
    table = int.from_bytes(content[begin : begin + 8], "little", signed=True)
    if table == -1:
        table = int.from_bytes(content[-8:], "little", signed=True)
    count = int.from_bytes(content[table + 4 : table + 8], "little")
    if not (begin + 8 <= table <= len(content) - 8 and count <= table - begin):
        raise _damaged(path, "table of chunks")
    records = header.vlrs.get("LasZipVlr")
    if not records:
        raise PrunusError(f"{path}: no record in the header says how its points are packed")
    record = records[0].record_data
    items = np.frombuffer(record[34:], "<u2", 3 * int.from_bytes(record[32:34], "little"))
    items = items.reshape(-1, 3).astype(np.int64)
    if items[:, 1].sum() != header.point_format.size or not any(record[12:16]):
        raise PrunusError(f"{path}: the record that says how points are packed fits no such points")
    held = io.BytesIO(content)
    held.seek(begin)
    chunks = lazrs.read_chunk_table(held, lazrs.LazVlr(record))
    if sum(size for _, size in chunks) != table - begin - 8:
        raise _damaged(path, "table of chunks")
    layers = sum(
        size if kind == EXTRA_BYTES else LAYERS.get(kind, 0) for kind, size, _ in items.tolist()
    )
    if layers:
        _check_layers(content, begin + 8, int(header.point_format.size), chunks, layers, path)


def _check_layers(
    content: bytes, at: int, point: int, chunks: list[tuple[int, int]], layers: int, path: Path
) -> None:
    """That each chunk is its first point, a count, the lengths of its layers, and those."""
    for _, size in chunks:
        start = at + point + 4
        lengths = np.frombuffer(content[start : start + 4 * layers], "<u4").sum(dtype=np.int64)
        if point + 4 + 4 * layers + int(lengths) != size:
            raise _damaged(path, "chunk of points")
        at += size


def _damaged(path: Path, what: str) -> PrunusError:
    return PrunusError(f"{path}: truncated or damaged: a {what} is not as long as the file says")
