"""What stands around the scene: counts, doubts, tables of labels, leaders and times, as HTML."""

from __future__ import annotations

import math
from html import escape

from prunus.io.skeletons.export import COLOURS
from prunus.model import Label, Skeleton
from prunus.model.branches import branches, lengths_by_label
from prunus.model.leaders import leaders
from prunus.report.tables import html_table
from prunus.result import Result
from prunus.trust import Trust

TRUST_NOTE = (
    '<p class="quiet">Trust: how likely a branch is right (its label, and what it hangs on); '
    "of several the mean.</p>"
)


def summary_of(result: Result) -> str:
    """The score, where there is one, and the sizes of the graph."""
    graph = result.graph
    if result.score is None:
        return (
            f"<p>{len(graph.superpoints.cloud):,} points, {len(graph.xyz)} nodes on the axes of "
            f"branches, {len(graph.edges)} edges between them.</p>"
        )
    return (
        f"<p>Score {result.score:.2f}. {len(graph.superpoints.cloud):,} points "
        f"({graph.superpoints.unused_points:,} in no superpoint), "
        f"{len(graph.xyz)} superpoints, {len(graph.edges)} candidate edges "
        f"(confidence: {escape(graph.scored.scorer)}), {len(graph.tips)} tips.</p>"
    )


def review_of(result: Result) -> str:
    """Why a person should look at the tree, if so."""
    if not result.review:
        return ""
    doubts = "".join(f"<li>{escape(text)}</li>" for text in result.review)
    return f'<div class="warn">A person should look before a machine acts:<ul>{doubts}</ul></div>'


def labels_of(result: Result) -> str:
    """How many branches of each label, how long, and how likely right."""
    skeleton, trust = result.in_house, result.trust
    found, lengths = branches(skeleton), lengths_by_label(skeleton)
    rows = []
    for label in Label:
        colour = "rgb({},{},{})".format(*COLOURS[label])
        name = (
            f'<span class="dot" style="background:{colour}"></span>{label.word.replace("_", " ")}'
        )
        own = [one.label == label for one in found]
        edges = int(skeleton.edges_with(label).sum())
        mean = None if trust is None or not any(own) else float(trust.branch[own].mean())
        rows.append([name, str(sum(own)), str(edges), f"{lengths[label]:.2f}", _share(mean)])
    heads = ["", "branches", "edges", "length [m]", "trust"]
    if trust is None:
        return "<h2>Labels</h2>" + html_table(heads[:-1], [row[:-1] for row in rows])
    return "<h2>Labels</h2>" + html_table(heads, rows) + TRUST_NOTE


def leaders_of(result: Result) -> str:
    """The leaders along the row."""
    trust = {} if result.trust is None else _by_tip(result.in_house, result.trust)
    rows = [
        [
            str(number),
            f"{leader.height:.2f}",
            f"{leader.lean:.0f}",
            "" if math.isnan(leader.spacing) else f"{leader.spacing:.2f}",
            str(leader.side_branches),
            _share(trust.get(leader.row)),
        ]
        for number, leader in enumerate(leaders(result.in_house), 1)
    ]
    names = ["leader", "height [m]", "lean [deg]", "spacing [m]", "side branches", "trust"]
    if not trust:
        names, rows = names[:-1], [row[:-1] for row in rows]
    return "<h2>Leaders, from left to right</h2>" + html_table(names, rows)


def _by_tip(skeleton: Skeleton, trust: Trust) -> dict[int, float]:
    """The trust in each branch by the row of its tip."""
    tips = [int(one.rows[-1]) for one in branches(skeleton)]
    return dict(zip(tips, trust.branch.tolist(), strict=True))


def _share(value: float | None) -> str:
    return "" if value is None else f"{value:.0%}"


def seconds_of(result: Result) -> str:
    """CPU and wall time by stage."""
    stages = [*result.seconds.items()]
    total = tuple(sum(times) for times in zip(*result.seconds.values(), strict=True))
    rows = [
        [name, f"{cpu * 1000:.0f}", f"{wall * 1000:.0f}"]
        for name, (cpu, wall) in [*stages, ("total", total)]
    ]
    note = '<p class="quiet">The first tree of a run also loads what it calls.</p>'
    return "<h2>Time by stage</h2>" + html_table(["stage", "CPU [ms]", "wall [ms]"], rows) + note
