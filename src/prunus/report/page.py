"""The page: scene, warnings, tables. Needs no network."""

from __future__ import annotations

import json
from collections.abc import Iterable
from html import escape
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from prunus.cuts import Plan
from prunus.report.around import labels_of, leaders_of, review_of, seconds_of, summary_of
from prunus.report.cuts import cut_traces, cuts_section
from prunus.report.scene import left_out_traces, scene_traces
from prunus.result import Result

STYLE = """
body{font:15px/1.45 system-ui,sans-serif;color:#222;margin:0 auto;max-width:1500px;padding:16px 24px}
h1{font-size:22px;margin:0}h2{font-size:16px;margin:22px 0 6px}p{margin:4px 0}
.room{display:grid;grid-template-columns:minmax(0,1fr) 400px;gap:24px}
@media(max-width:1000px){.room{grid-template-columns:1fr}}
#scene{height:780px;border:1px solid #ddd}#score{height:230px}
table{border-collapse:collapse;width:100%}td,th{padding:2px 8px;text-align:right;font-weight:400}
th{color:#666;border-bottom:1px solid #ccc}td:first-child,th:first-child{text-align:left;padding-left:0}
.dot{display:inline-block;width:11px;height:11px;border-radius:6px;margin-right:7px}
.warn{background:#fff4d6;border-left:4px solid #e69f00;padding:6px 12px;margin:6px 0}
.cuts td{text-align:left;vertical-align:top}.cuts th{text-align:left}
.quiet{color:#666;font-size:13px}pre{font-size:12px;overflow:auto;background:#f6f6f6;padding:8px}
"""

AXIS = {"backgroundcolor": "#fcfcfc", "gridcolor": "#e5e5e5", "showbackground": True}
WIDTH, HEIGHT = 2.1, 1.7
"""The cloud in the scene is at most so wide and so high when the page opens."""
LAYOUT: dict[str, Any] = {
    "margin": {"l": 0, "r": 0, "t": 0, "b": 0},
    # Below the scene, where it hides no branch.
    "legend": {"orientation": "h", "x": 0, "y": 0, "yanchor": "top", "itemsizing": "constant"},
    "scene": {
        "aspectmode": "manual",
        "camera": {
            "eye": {"x": 0.35, "y": -1.6, "z": 0.2},
            "up": {"x": 0, "y": 0, "z": 1},
            "projection": {"type": "orthographic"},
        },
        "xaxis": {**AXIS, "title": {"text": "X along the row [m]"}},
        "yaxis": {**AXIS, "title": {"text": "Y depth [m]"}},
        "zaxis": {**AXIS, "title": {"text": "Z up [m]"}},
    },
}
SCORE_LAYOUT = {
    "margin": {"l": 42, "r": 8, "t": 6, "b": 36},
    "xaxis": {"title": {"text": "iteration"}},
    "yaxis": {"title": {"text": "best score"}},
    "showlegend": False,
}


def report_page(
    result: Result, title: str, notes: Iterable[str] = (), plan: Plan | None = None
) -> str:
    """The report of one tree as HTML that holds all it needs; `notes` tell how it was read.

    `plan` is its pruning plan, in the house frame.
    """
    library = _plotly_library()
    traces = scene_traces(result.in_house, result.refined.skeleton, result.graph)
    if plan is not None:
        traces += cut_traces(plan)
    if result.isolated is not None:
        traces += left_out_traces(result.scan, result.isolated.kind)
    layout = LAYOUT | {"scene": LAYOUT["scene"] | _frame_of(result)}
    return f"""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>{escape(title)} - prunus</title>
<style>{STYLE}</style><script>{library}</script></head><body>
<h1>{escape(title)}</h1>{summary_of(result)}
{review_of(result)}
<div class="room"><div><div id="scene"></div>
<p class="quiet">Drag turns, wheel zooms. Click a name in the list to show or hide it.
House frame: X along the row, Y depth, Z up, metres, around the middle of the cloud; the files
beside this page are in the axes of the input, in metres.</p>
{"".join(f'<p class="quiet">{escape(note)}</p>' for note in notes)}
{"" if plan is None else cuts_section(plan)}</div>
<div>{labels_of(result)}{leaders_of(result)}
{_score_of(result)}{seconds_of(result)}
<details><summary class="quiet">parameters, seed {result.seed}</summary>
<pre>{escape(result.params.to_toml())}</pre></details></div></div>
<script>
const quiet = {{responsive: true, displaylogo: false}};
Plotly.newPlot("scene", {json.dumps(traces)}, {json.dumps(layout)}, quiet);
</script></body></html>
"""


def _score_of(result: Result) -> str:
    """The best score by iteration; nothing where the method goes by none."""
    if result.score is None:
        return ""
    score = [{"y": [round(value, 4) for value in result.history.tolist()], "mode": "lines"}]
    return f"""<h2>Score by iteration</h2><div id="score"></div>
<script>Plotly.newPlot("score", {json.dumps(score)}, {json.dumps(SCORE_LAYOUT)},
{{responsive: true, displaylogo: false}});</script>"""


def _frame_of(result: Result) -> dict[str, Any]:
    """Axes that hold the whole scan, zoomed so that the tree fills the scene."""
    extent = np.ptp(result.graph.superpoints.cloud.xyz, axis=0)
    zoom = min(WIDTH / max(extent[0], 1e-6), HEIGHT / max(extent[2], 1e-6))
    low, high = result.scan.xyz.min(axis=0), result.scan.xyz.max(axis=0)
    ratio = dict(zip("xyz", (zoom * (high - low)).tolist(), strict=True))
    ranges = zip("xyz", np.column_stack([low, high]).tolist(), strict=True)
    axes = {f"{one}axis": LAYOUT["scene"][f"{one}axis"] | {"range": ends} for one, ends in ranges}
    return {"aspectratio": ratio} | axes


def _plotly_library() -> str:
    """The JavaScript that comes with plotly, read without importing plotly (0.2 s)."""
    spec = find_spec("plotly")
    assert spec is not None and spec.origin is not None
    library = Path(spec.origin).parent / "package_data" / "plotly.min.js"
    return library.read_text(encoding="utf-8")
