"""The 3D scene of the report, as plotly traces: cloud, skeleton by label, evidence to switch on."""

from __future__ import annotations

from typing import Any

import numpy as np

from prunus.io.skeletons.export import COLOURS
from prunus.model import Floats, Ints, Kind, Label, PointCloud, SeededGraph, Skeleton
from prunus.model.branches import branches

MOST_POINTS = 40_000
"""More points of the cloud would make the page slow, not clearer."""
CLASSES = ((0.8, 1.01, "#7a5195"), (0.4, 0.8, "#bc7fbf"), (0.0, 0.4, "#d9d0dd"))
"""Confidence classes of candidate edges: from, up to, colour."""

REFINED = "#222222"
GAP = np.full((1, 3), np.nan)
"""Ends a line."""

LEFT_OUT = {
    Kind.NEIGHBOUR: "#b8860b",
    Kind.BEHIND: "#4f86c6",
    Kind.GROUND: "#8d6e63",
    Kind.POST: "#444444",
    Kind.WIRE: "#d62728",
    Kind.STRAY: "#bbbbbb",
}
"""Colours of what is not the tree."""

Trace = dict[str, Any]


def scene_traces(skeleton: Skeleton, fine: Skeleton, graph: SeededGraph) -> list[Trace]:
    """Traces of a skeleton, the same refined, and its graph, all in the house frame."""
    return [
        _cloud(graph),
        *(_branch(skeleton, label) for label in Label),
        _points("base", skeleton.xyz[:1], "#cc0000", 7, "diamond"),
        _points("tips", graph.xyz[graph.tips], "#cc79a7", 5, "diamond"),
        _refined(fine),
        _points("superpoints", graph.xyz, "#888888", 3, "circle", shown=False),
        *(_candidates(graph, low, high, colour) for low, high, colour in CLASSES),
    ]


def left_out_traces(scan: PointCloud, kind: Ints) -> list[Trace]:
    """Traces of the points of a scan that are not the tree, by their kind (P,); to switch on."""
    step = -(-len(scan) // MOST_POINTS)
    xyz, kind = scan.xyz[::step], kind[::step]
    return [
        _points(f"left out: {one.name.lower()}", xyz[kind == one], colour, 1.2, "circle", False)
        for one, colour in LEFT_OUT.items()
        if (kind == one).any()
    ]


def _cloud(graph: SeededGraph) -> Trace:
    cloud = graph.superpoints.cloud
    step = -(-len(cloud) // MOST_POINTS)
    trace = _points("cloud", cloud.xyz[::step], "#9a9a9a", 1.2, "circle")
    trace["marker"]["opacity"] = 0.55
    if cloud.rgb is not None:
        trace["marker"]["color"] = [f"rgb({r},{g},{b})" for r, g, b in cloud.rgb[::step].tolist()]
    return trace


def _branch(skeleton: Skeleton, label: Label) -> Trace:
    rows = np.flatnonzero(skeleton.edges_with(label))
    pairs = np.column_stack([skeleton.parent[rows], rows])
    colour = "#{:02x}{:02x}{:02x}".format(*COLOURS[label])
    return _lines(label.word.replace("_", " "), skeleton.xyz, pairs, colour, 9)


def _refined(skeleton: Skeleton) -> Trace:
    """The refined skeleton, a line a branch, and how thick it is; to switch on."""
    runs = [np.append(branch.rows, -1) for branch in branches(skeleton)] or [np.array([-1])]
    rows = np.concatenate(runs)
    xyz = np.concatenate([skeleton.xyz, GAP])[rows]
    radius = np.append(skeleton.radius, np.nan)[rows]
    return {
        **_columns(xyz),
        **_common("refined", shown=False),
        "mode": "lines",
        "line": {"width": 4, "color": REFINED},
        "text": ["" if np.isnan(r) else f"{2e3 * r:.0f} mm thick" for r in radius.tolist()],
        "hoverinfo": "text",
    }


def _candidates(graph: SeededGraph, low: float, high: float, colour: str) -> Trace:
    chosen = graph.edges[(graph.confidence >= low) & (graph.confidence < high)]
    name = f"candidates, confidence {low:.1f} to {min(high, 1):.1f}"
    return _lines(name, graph.xyz, chosen, colour, 2, shown=False)


def _points(
    name: str, xyz: Floats, colour: str, size: float, symbol: str, shown: bool = True
) -> Trace:
    return {
        **_columns(xyz),
        **_common(name, shown),
        "mode": "markers",
        "marker": {"size": size, "color": colour, "symbol": symbol},
        "hoverinfo": "skip" if name == "cloud" else "name+x+y+z",
    }


def _lines(
    name: str, xyz: Floats, pairs: Ints, colour: str, width: float, shown: bool = True
) -> Trace:
    broken = np.full((len(pairs), 3, 3), np.nan)
    broken[:, :2] = xyz[pairs]
    return {
        **_columns(broken.reshape(-1, 3)),
        **_common(name, shown),
        "mode": "lines",
        "line": {"width": width, "color": colour},
    }


def _common(name: str, shown: bool) -> Trace:
    return {"type": "scatter3d", "name": name, "visible": True if shown else "legendonly"}


def _columns(xyz: Floats) -> Trace:
    return {
        axis: [None if np.isnan(value) else value for value in np.round(xyz[:, i], 4).tolist()]
        for i, axis in enumerate("xyz")
    }
