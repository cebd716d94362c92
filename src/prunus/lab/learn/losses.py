"""The losses of a training: a line of JSON every so many steps, and a page that draws them."""

from __future__ import annotations

import json
import math
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from prunus.files.jsonl import read_lines_of
from prunus.files.safely import write_bytes
from prunus.lab.experiment.figures import Frame, round_up
from prunus.model import Floats

LOG, PICTURE = "log.jsonl", "losses.html"
SMOOTHED_OVER = 0.05  # of the rows, for the darker line
TITLES = {
    "role": "role: cross entropy",
    "offset": "offset to the axis: mean, in 3 cm",
    "log_radius": "radius: mean error of its logarithm",
    "toward_foot": "direction to the foot: 1 - cosine",
    "accuracy": "voxels whose role is right",
    "owner": "whose wood it is: cross entropy",
    "owned": "wood given to the right tree",
}
STYLE = """
body{font:15px/1.45 system-ui,sans-serif;color:#222;margin:0 auto;max-width:1250px;padding:16px}
h1{font-size:22px;margin:0 0 6px}svg{width:100%}.title{font-size:13px}
.room{display:grid;grid-template-columns:repeat(auto-fill,minmax(360px,1fr));gap:14px}
.axis{font-size:11px;text-anchor:middle;fill:#555}
.tick{font-size:10px;text-anchor:middle;fill:#777}.end{text-anchor:end}.grid{stroke:#e5e5e5}
"""

Losses = dict[str, float]
Row = dict[str, Any]


def log_losses(folder: Path, step: int, recent: Sequence[Losses]) -> None:
    """Add the means of the last steps to the log, and draw the page anew."""
    means = {name: round(_mean([one[name] for one in recent]), 4) for name in recent[0]}
    rows = [*logged(folder), {"step": step, "at": time.strftime("%H:%M:%S"), **means}]
    _keep(folder, rows)


def forget_after(folder: Path, step: int) -> None:
    """Take out of the log what came after a step: it will be done again."""
    rows = logged(folder)
    kept = [row for row in rows if row["step"] <= step]
    if len(kept) < len(rows):
        _keep(folder, kept)


def logged(folder: Path) -> list[Row]:
    """The rows of the log of a folder."""
    path = folder / LOG
    held = path.exists() and path.stat().st_size
    return [row for _, row in read_lines_of(path)] if held else []


def losses_page(rows: Sequence[Row]) -> str:
    """The losses over the steps, as HTML that holds all it needs."""
    step = np.array([row["step"] for row in rows], np.float64)
    figures = (
        _curve(title, step, np.array([row[name] for row in rows], np.float64))
        for name, title in TITLES.items()
        if name in rows[0]
    )
    return f"""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>Losses of the training - prunus</title>
<style>{STYLE}</style></head><body><h1>Losses of the training</h1>
<div class="room">{"".join(figures)}</div></body></html>
"""


def _keep(folder: Path, rows: Sequence[Row]) -> None:
    lines = "".join(json.dumps(row) + "\n" for row in rows)
    write_bytes(folder / LOG, lines.encode())
    write_bytes(folder / PICTURE, losses_page(rows).encode())


def _mean(values: Sequence[float]) -> float:
    """The mean of those that are numbers: of a scan without wood there is no error of an axis."""
    known = [value for value in values if math.isfinite(value)]
    return sum(known) / len(known) if known else 0.0


def _curve(title: str, step: Floats, values: Floats) -> str:
    """A thin line of the values, and a thick one of their running mean."""
    thousands, most = step / 1000, float(values.max(initial=0))
    frame = Frame(title, "thousand steps", "", round_up(thousands.max(initial=0)), round_up(most))
    width = max(1, round(SMOOTHED_OVER * len(step)))
    for line, look in ((values, "1"), (_running_mean(values, width), "2.5")):
        places = (frame.at(x, y) for x, y in zip(thousands, line, strict=True))
        points = " ".join(f"{x:.1f},{y:.1f}" for x, y in places)
        frame.parts.append(
            f'<polyline points="{points}" fill="none" stroke="#0072b2" stroke-width="{look}" '
            f'stroke-opacity="{0.35 if look == "1" else 1}"/>'
        )
    return frame.svg()


def _running_mean(values: Floats, width: int) -> Floats:
    """The mean of each value and those just before it, so many in all."""
    sums = np.cumsum(np.concatenate([[0.0], values]))
    last = np.arange(1, len(values) + 1)
    first = np.maximum(last - width, 0)
    return np.asarray((sums[last] - sums[first]) / (last - first))
