"""What the page says, as HTML; every text that came from outside is escaped."""

from __future__ import annotations

import math
from html import escape

import numpy as np

from prunus.cuts import Cut, Plan
from prunus.io.skeletons.export import COLOURS
from prunus.model import Floats, Label
from prunus.report.cuts import LOOK, SURE
from prunus.studio.picture import KINDS, Picture, colour_of

STYLE = "padding:2px 12px 8px;font-size:13px;line-height:1.45;overflow-wrap:anywhere"


def block(*lines: str) -> str:
    """Lines of HTML below each other."""
    return f'<div style="{STYLE}">{"<br>".join(line for line in lines if line)}</div>'


def quiet(text: str) -> str:
    """A remark, escaped."""
    return f'<span style="color:#777">{escape(text)}</span>'


def loud(text: str) -> str:
    """What must be seen, escaped."""
    return f'<b style="color:#b45309">{escape(text)}</b>'


def dot(label: Label) -> str:
    """The colour of a label."""
    return _dot(COLOURS[label])


def _dot(rgb: tuple[int, int, int]) -> str:
    colour = "rgb({},{},{})".format(*rgb)
    return (
        '<span style="display:inline-block;width:11px;height:11px;border-radius:6px;'
        f'margin-right:6px;background:{colour}"></span>'
    )


def word_of(label: Label) -> str:
    """The name of a label as a person writes it."""
    return label.word.replace("_", " ")


def legend(picture: Picture) -> str:
    """The labels with their colours, how many branches each has, and their metres."""
    rows = []
    for label in Label:
        own = [branch for branch in picture.branches if branch.label == label]
        metres = sum(branch.length for branch in own)
        told = f"{len(own)}, {metres:.1f} m" if picture.skeleton is not None else ""
        rows.append(f"{dot(label)}{word_of(label)} {quiet(told)}")
    return block(*rows)


def kinds(picture: Picture) -> str:
    """The kinds of points with their colours, and how many each has."""
    if picture.kind is None:
        return ""
    counts = np.bincount(picture.kind, minlength=len(KINDS)).tolist()
    rows = zip(KINDS.items(), counts, strict=True)
    return block(*(f"{_dot(c)}{k.name.lower()} {quiet(f'{n:,}')}" for (k, c), n in rows))


def card(picture: Picture, row: int) -> str:
    """What is known of the edge into a row, and of the branch that holds it."""
    assert picture.skeleton is not None
    skeleton = picture.skeleton
    branch, label = picture.branches[int(picture.owner[row])], Label(skeleton.label[row])
    name, below = (picture.names[picture.nodes[r]] for r in (row, int(branch.rows[0])))
    place = list(branch.rows).index(row)
    sure = float(skeleton.confidence[row])
    turn = _angle(skeleton.edge_vectors[int(skeleton.parent[row])], skeleton.edge_vectors[row])
    leave = _angle(
        skeleton.edge_vectors[int(branch.rows[0])], skeleton.edge_vectors[int(branch.rows[1])]
    )
    return block(
        f"{dot(label)}<b>{escape(name)}</b>, {branch.length:.2f} m",
        f"leaves {escape(below)}{_degrees(leave)}",
        f"edge {place} of {len(branch.rows) - 1}: {100 * skeleton.lengths[row]:.1f} cm"
        + (f", turns{_degrees(turn)}" if turn is not None else ""),
        "confidence " + ("unknown" if math.isnan(sure) else f"{sure:.2f}"),
        quiet(f"node {picture.nodes[row]}"),
    )


def plan_card(plan: Plan, chosen: Cut | None, every: bool) -> str:
    """How many cuts there are, and those that are to be looked at, or all; the chosen one bold."""
    looked = [cut for cut in plan.cuts if cut.needs_review]
    shown = [
        f"<b>{escape(cut.branch)}</b>" if cut is chosen else escape(cut.branch)
        for cut in (plan.cuts if every else looked)
    ]
    return block(
        f"{_dot(colour_of(SURE))}{len(plan.cuts) - len(looked)} cuts by themselves",
        f"{_dot(colour_of(LOOK))}{len(looked)} for a person to look at first",
        ", ".join(shown),
    )


def cut_card(cut: Cut) -> str:
    """What is known of a cut, and why a person should look."""
    way = cut.approach
    doubt = f" &plusmn; {_mm(cut.diameter_error)}" if math.isfinite(cut.diameter_error) else ""
    litres = math.isfinite(cut.removed_volume)
    volume = f", {1e6 * cut.removed_volume:.0f} cm&sup3;" if litres else ""
    reasons = [loud(reason) for reason in cut.reasons]
    return block(
        f"<b>{escape(cut.branch)}</b> {quiet(cut.rule.replace('_', ' '))}",
        escape(cut.because),
        f"{_mm(cut.diameter)}{doubt} mm thick"
        + (f", stub {_mm(cut.stub)} mm" if math.isfinite(cut.stub) else ""),
        f"{cut.removed_length:.2f} m of wood come down{volume}",
        "" if way is None else f"the way to it has {way.half_angle:.0f}&deg; free",
        f"confidence {cut.confidence:.2f}",
        *(["look first:", *reasons] if reasons else [quiet("nothing is doubtful")]),
    )


def _mm(value: float) -> str:
    return f"{1e3 * value:.0f}" if math.isfinite(value) else "?"


def _angle(one: Floats, other: Floats) -> float | None:
    """Degrees between two vectors; None where one has no length."""
    lengths = float(np.linalg.norm(one) * np.linalg.norm(other))
    if lengths == 0:
        return None
    return math.degrees(math.acos(max(-1.0, min(1.0, float(one @ other) / lengths))))


def _degrees(angle: float | None) -> str:
    return "" if angle is None else f" at {angle:.0f}°"
