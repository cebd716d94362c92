"""Units that coordinate reference systems tell: as GeoTIFF keys, and as well-known text (WKT)."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from prunus.io.clouds.units import UNITS, known

MODEL, GEOGRAPHIC, PROJECTED = 1024, 2048, 3072
"""GeoTIFF keys: the kind of system, and the codes of a geographic and of a projected one."""
LINEAR, LINEAR_SIZE, VERTICAL = 3076, 3077, 4099
"""GeoTIFF keys: the unit of x and y, metres in it, and the unit of heights."""
CODES = {
    9001: UNITS["m"],
    9002: UNITS["ft"],
    9003: UNITS["us-ft"],
    1025: UNITS["mm"],
    1033: UNITS["cm"],
}
"""Metres in a unit, by its EPSG code."""
OWN = 32767
"""The code of a unit whose size is given."""
IN_METRES = ((32601, 32660), (32701, 32760), (25801, 25860), (26901, 26923), (2154, 2154))
"""EPSG codes of projected systems in metres that are common: UTM, and Lambert 93."""

DEGREES = "the header says that x and y are degrees (a geographic system), not lengths"
GEOCENTRIC = "the header says that the coordinates are geocentric: no axis points up"

FLAT = ("PROJCS", "PROJCRS", "PROJECTEDCRS", "LOCAL_CS", "ENGCRS", "ENGINEERINGCRS")
ROUND = ("GEOGCS", "GEOGCRS", "GEOGRAPHICCRS", "GEODCRS", "GEODETICCRS")
UPRIGHT = ("VERT_CS", "VERTCRS", "VERTICALCRS")
"""Kinds of systems in WKT, of 2001 and of 2015 and later."""

TOKEN = re.compile(r'"(?:[^"]|"")*"|[\[\](),]|[^\s\[\](),"]+')
DEEPEST = 40
"""Brackets within brackets, at most."""


@dataclass(frozen=True, kw_only=True)
class Reference:
    """Metres in one unit of x and y, and of heights, where told; why they are none; notes."""

    metres: float | None = None
    up: float | None = None
    fault: str = ""
    notes: list[str] = field(default_factory=list)


def of_keys(directory: bytes, doubles: bytes) -> Reference:
    """What GeoTIFF keys tell: rows of four 16-bit numbers, the first one a header."""
    rows = np.frombuffer(directory[: len(directory) // 8 * 8], "<u2").reshape(-1, 4)[1:]
    keys = {int(key): (int(where), int(value)) for key, where, _, value in rows}
    numbers = np.frombuffer(doubles[: len(doubles) // 8 * 8], "<f8")
    code = {key: value for key, (where, value) in keys.items() if where == 0}
    if code.get(MODEL) == 3:
        return Reference(fault=GEOCENTRIC)
    if code.get(MODEL) == 2 or (
        GEOGRAPHIC in code and not code.keys() & {PROJECTED, LINEAR, MODEL}
    ):
        return Reference(fault=DEGREES)
    metres = CODES.get(code.get(LINEAR, 0))
    if LINEAR_SIZE in keys and keys[LINEAR_SIZE][1] < len(numbers):
        size = float(numbers[keys[LINEAR_SIZE][1]])
        metres = known(size) if np.isfinite(size) and size > 0 and metres is None else metres
    projected = code.get(PROJECTED, 0)
    if metres is None and any(low <= projected <= high for low, high in IN_METRES):
        metres = UNITS["m"]
    notes = []
    if metres is None and LINEAR in code:
        notes.append(
            f"the header gives x and y in the unit EPSG:{code[LINEAR]}, which is not known"
        )
    elif metres is None and projected not in (0, OWN):
        notes.append(f"the header gives EPSG:{projected}, but no unit")
    return Reference(metres=metres, up=CODES.get(code.get(VERTICAL, 0)), notes=notes)


def of_wkt(text: str) -> Reference:
    """What well-known text tells, of either version."""
    root = _tree(text)
    flat = _first(root, FLAT)
    if flat is None:
        if _first(root, ("GEOCCS",)) is not None or _is_geocentric(root):
            return Reference(fault=GEOCENTRIC)
        return Reference(fault=DEGREES if _first(root, ROUND) is not None else "")
    upright = _first(root, UPRIGHT)
    return Reference(metres=_unit(flat), up=None if upright is None else _unit(upright))


Node = tuple[str, list[Any]]
"""A keyword and what stands in its brackets: nodes and words."""


def _tree(text: str) -> Node:
    """The text as nodes within nodes; what is not closed is closed at the end."""
    stack: list[Node] = [("", [])]
    word = ""
    for token in TOKEN.findall(text):
        if token in "[(":
            if len(stack) > DEEPEST:
                raise ValueError("brackets in the WKT go too deep")
            node: Node = (word.upper(), [])
            stack[-1][1].append(node)
            stack.append(node)
            word = ""
            continue
        if word:
            stack[-1][1].append(word)
        word = "" if token in "])," else token
        if token in "])" and len(stack) > 1:
            stack.pop()
    return stack[0]


def _first(node: Node, kinds: tuple[str, ...]) -> Node | None:
    """The first node of these kinds, outermost first."""
    level = [node]
    while level:
        inside = [child for _, held in level for child in held if isinstance(child, tuple)]
        found = next((child for child in inside if child[0] in kinds), None)
        if found is not None:
            return found
        level = inside
    return None


def _unit(system: Node) -> float | None:
    """Metres in the unit of a system: its own, or that of its axes; not of what is within."""
    own = [child for child in system[1] if isinstance(child, tuple)]
    axes = [c for child in own if child[0] == "AXIS" for c in child[1] if isinstance(c, tuple)]
    for name, held in [*own, *axes]:
        if name in ("UNIT", "LENGTHUNIT") and len(held) > 1 and isinstance(held[1], str):
            metres = float(held[1])
            return known(metres) if np.isfinite(metres) and metres > 0 else None
    return None


def _is_geocentric(root: Node) -> bool:
    system = _first(root, ROUND)
    axes = _first(system, ("CS",)) if system is not None else None
    return axes is not None and str(axes[1][:1]).lower().strip("[]'") == "cartesian"
