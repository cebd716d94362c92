"""The figures of the paper's result section as inline SVG."""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape

import numpy as np

from prunus.model import Ints

COLOURS = {
    "corrected by hand": "#d55e00",
    "paper": "#999999",
    "default": "#0072b2",
    "paper, oracle": "#cc79a7",
}
"""Of each way in the figures: Okabe and Ito's palette."""
WIDE, HIGH = 380, 230
LEFT, BOTTOM, TOP, RIGHT = 42, 34, 22, 10


class Frame:
    """An SVG picture with axes from (0, 0) to (x_most, y_most)."""

    def __init__(self, title: str, x: str, y: str, x_most: float, y_most: float) -> None:
        """`x` and `y` name the axes, with their units."""
        self.x_most, self.y_most = x_most or 1.0, y_most or 1.0
        self.parts = [
            f'<text x="{LEFT}" y="14" class="title">{escape(title)}</text>',
            f'<text x="{(LEFT + WIDE - RIGHT) / 2}" y="{HIGH - 4}" class="axis">{escape(x)}</text>',
            f'<text transform="translate(11 {HIGH / 2}) rotate(-90)" class="axis">'
            f"{escape(y)}</text>",
        ]
        for k in range(5):
            self._tick(k / 4)

    def _tick(self, share: float) -> None:
        x, y = self.at(share * self.x_most, share * self.y_most)
        self.parts += [
            f'<line x1="{LEFT}" x2="{WIDE - RIGHT}" y1="{y:.1f}" y2="{y:.1f}" class="grid"/>',
            f'<text x="{LEFT - 4}" y="{y + 3:.1f}" class="tick end">'
            f"{share * self.y_most:.3g}</text>",
            f'<text x="{x:.1f}" y="{HIGH - BOTTOM + 13}" class="tick">'
            f"{share * self.x_most:.3g}</text>",
        ]

    def at(self, x: float, y: float) -> tuple[float, float]:
        """Where a point of the data lies in the picture."""
        across = LEFT + min(x / self.x_most, 1) * (WIDE - LEFT - RIGHT)
        return across, HIGH - BOTTOM - min(y / self.y_most, 1) * (HIGH - BOTTOM - TOP)

    def svg(self) -> str:
        """The picture."""
        return f'<svg viewBox="0 0 {WIDE} {HIGH}" role="img">{"".join(self.parts)}</svg>'


def histogram(title: str, values: dict[str, Sequence[float]], most: float = 1.0) -> str:
    """Distributions of edit ratios, one a way, side by side; medians dotted.

    The last bin holds all above.
    """
    bins = 10
    known = {way: [v for v in own if not math.isnan(v)] for way, own in values.items()}
    counts = {way: _counted(own, most, bins) for way, own in known.items()}
    top = max(int(count.max()) for count in counts.values())
    frame = Frame(title, "edit ratio", "trials", most, round_up(top))
    each = most / bins / (len(counts) + 0.4)
    for k, (way, count) in enumerate(counts.items()):
        for b, number in enumerate(count.tolist()):
            x0, y0 = frame.at(b * most / bins + (k + 0.2) * each, number)
            x1, y1 = frame.at(b * most / bins + (k + 1.2) * each, 0)
            frame.parts.append(
                f'<rect x="{x0:.1f}" y="{y0:.1f}" width="{x1 - x0:.1f}" height="{y1 - y0:.1f}" '
                f'fill="{COLOURS[way]}"/>'
            )
        if known[way]:
            x, _ = frame.at(float(np.median(known[way])), 0)
            frame.parts.append(
                f'<line x1="{x:.1f}" x2="{x:.1f}" y1="{TOP}" y2="{HIGH - BOTTOM}" '
                f'stroke="{COLOURS[way]}" stroke-width="2" stroke-dasharray="2 3"/>'
            )
    return frame.svg()


def _counted(values: Sequence[float], most: float, bins: int) -> Ints:
    """How many values lie in each of equal bins up to `most`; those above in the last."""
    place = np.minimum((np.array(values) / most * bins).astype(np.int64), bins - 1)
    return np.bincount(place, minlength=bins)


def scatter(
    title: str, x: str, y: str, points: dict[str, tuple[Sequence[float], Sequence[float]]]
) -> str:
    """A point a trial, coloured by way."""
    x_most = max((max(xs, default=0) for xs, _ in points.values()), default=1)
    y_most = max((max(ys, default=0) for _, ys in points.values()), default=1)
    frame = Frame(title, x, y, round_up(x_most), round_up(y_most))
    for way, (xs, ys) in points.items():
        for px, py in zip(xs, ys, strict=True):
            cx, cy = frame.at(px, py)
            frame.parts.append(
                f'<circle cx="{cx:.1f}" cy="{cy:.1f}" r="2.6" fill="{COLOURS[way]}" '
                'fill-opacity="0.6"/>'
            )
    return frame.svg()


def legend(ways: Sequence[str]) -> str:
    """Which colour is which way."""
    dots = (f'<span class="dot" style="background:{COLOURS[way]}"></span>{way}' for way in ways)
    return '<p class="quiet">' + " &nbsp; ".join(dots) + "</p>"


def round_up(most: float) -> float:
    """The next number that an axis may end at."""
    if most <= 0:
        return 1.0
    size = 10.0 ** math.floor(math.log10(most))
    return next(size * step for step in (1, 2, 4, 5, 8, 10) if size * step >= most)
