"""The pruning plan in the report: blades and the ways to them in the scene, and a table."""

from __future__ import annotations

import math
from html import escape
from typing import Any

import numpy as np

from prunus.cuts import Cut, Plan
from prunus.model import Floats, Ints
from prunus.report.tables import html_table

Trace = dict[str, Any]
SURE, LOOK, WAY = "#111111", "#e4002b", "#56b4e9"
"""Colours of cuts, of those that a person looks at first, and of the ways to them."""
BLADE = 0.03
"""A blade is drawn with this radius, metres."""
LONG = 0.12
"""A free cone is drawn so long, metres."""
CORNERS = 20
KINDS = (("cuts", SURE, False), ("cuts to look at first", LOOK, True))


def cut_traces(plan: Plan) -> list[Trace]:
    """Traces of a plan in the house frame: blades as discs, free ways as cones."""
    traces = []
    for name, colour, look in KINDS:
        some = [cut for cut in plan.cuts if cut.needs_review == look]
        if some:
            discs = [disc(cut) for cut in some]
            traces += [_mesh(name, discs, colour, 0.9), _points(name, some, colour)]
    cones = [cone(cut) for cut in plan.cuts if cut.approach is not None]
    if cones:
        traces.append(_mesh("free ways to the cuts", cones, WAY, 0.25) | {"visible": "legendonly"})
    return traces


def cuts_section(plan: Plan) -> str:
    """The table of the cuts, and which branches the rules left and why, as HTML."""
    rows = [
        [
            escape(cut.branch), escape(cut.rule.replace("_", " ")), _mm(cut.diameter),
            f"{cut.removed_length:.2f}", f"{cut.confidence:.2f}",
            escape("; ".join(cut.reasons)) or "-",
        ]
        for cut in plan.cuts
    ]  # fmt: skip
    names = ["branch", "rule", "at cut [mm]", "removes [m]", "confidence", "look first, for"]
    left = "".join(
        f"<li>{escape(f'{one.branch}: {one.why} ({one.rule})')}</li>" for one in plan.left
    )
    return (
        "<h2>Pruning cuts, by the shipped rules</h2>"
        f'<div class="cuts">{html_table(names, rows)}</div>'
        f'<details><summary class="quiet">{len(plan.left)} times a rule left a branch, and why'
        f'</summary><ul class="quiet">{left}</ul></details>'
    )


def _mm(value: float) -> str:
    return f"{1e3 * value:.0f}" if math.isfinite(value) else "?"


def disc(cut: Cut) -> tuple[Floats, Ints]:
    """The blade of a cut, house frame, as vertices (V, 3) and triangles (F, 3)."""
    point = np.array(cut.point)
    return _fan(point, point, np.array(cut.blade_normal), BLADE)


def cone(cut: Cut) -> tuple[Floats, Ints]:
    """The free cone of a cut with a way to it, its tip at the cut; at least a needle."""
    assert cut.approach is not None
    way = -np.array(cut.approach.direction)
    wide = LONG * math.tan(math.radians(min(max(cut.approach.half_angle, 1.0), 60.0)))
    point = np.array(cut.point)
    return _fan(point, point + LONG * way, way, wide)


def _fan(tip: Floats, middle: Floats, normal: Floats, radius: float) -> tuple[Floats, Ints]:
    """Triangles from a tip to a ring about a middle."""
    aside = np.cross(normal, np.eye(3)[int(np.abs(normal).argmin())])
    aside /= np.linalg.norm(aside)
    turn = 2 * np.pi * np.arange(CORNERS) / CORNERS
    ring = np.outer(np.cos(turn), aside) + np.outer(np.sin(turn), np.cross(normal, aside))
    number = np.arange(CORNERS)
    faces = np.column_stack([np.zeros(CORNERS, int), 1 + number, 1 + (number + 1) % CORNERS])
    return np.concatenate([tip[None], middle + radius * ring]), faces


def joined(parts: list[tuple[Floats, Ints]]) -> tuple[Floats, Ints]:
    """Vertices (V, 3) and triangles (F, 3) of one or more meshes as those of one."""
    start = np.cumsum([0, *(len(vertices) for vertices, _ in parts)])
    faces = [corners + first for (_, corners), first in zip(parts, start, strict=False)]
    return np.concatenate([vertices for vertices, _ in parts]), np.concatenate(faces)


def _mesh(name: str, parts: list[tuple[Floats, Ints]], colour: str, opacity: float) -> Trace:
    xyz, faces = joined(parts)
    xyz = np.round(xyz, 4)
    corners = {key: faces[:, i].tolist() for i, key in enumerate("ijk")}
    places = {axis: xyz[:, i].tolist() for i, axis in enumerate("xyz")}
    look = {"color": colour, "opacity": opacity, "hoverinfo": "skip", "showlegend": True}
    return {"type": "mesh3d", "name": name, "legendgroup": name, **places, **corners, **look}


def _points(name: str, cuts: list[Cut], colour: str) -> Trace:
    xyz = np.round(np.array([cut.point for cut in cuts]), 4)
    return {
        "type": "scatter3d", "name": name, "legendgroup": name, "showlegend": False,
        "mode": "markers", "marker": {"size": 4, "color": colour}, "hoverinfo": "text",
        "text": [escape("; ".join([f"{cut.branch}: {cut.because}", *cut.reasons])) for cut in cuts],
        **{axis: xyz[:, i].tolist() for i, axis in enumerate("xyz")},
    }  # fmt: skip
