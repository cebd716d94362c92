"""The experiment as one HTML page, as lines of Markdown, and as CSV."""

from __future__ import annotations

from collections.abc import Callable
from html import escape
from typing import Any

from prunus.io.tables import csv_bytes
from prunus.lab.experiment.figures import histogram, legend, scatter
from prunus.lab.experiment.habits import HABITS
from prunus.lab.experiment.tables import all_stages, before, by_label, edit_ratios
from prunus.lab.experiment.trial import ABLATIONS, BY_HAND, WAYS, Record
from prunus.lab.learn.edges.tables import PAPER
from prunus.model import Label
from prunus.report.tables import html_table

IN_PAPER: dict[str, str] = {
    "edit ratio, median": "0.30",
    "edit ratio, best to worst": "0.01 to 0.74",
    "trunk, median": "0.00",
    "support, median": "0.42",
    "leader, median": "0.21",
    "side branch, median": "0.50",
    "CPU seconds, median": "120.8 (mean)",
    "of it before the search": "5 %",
}
"""What the paper has, on 29 real trees corrected by people."""
SHOWN = (BY_HAND, "paper", "default", "paper, oracle")
"""Ways in the figures."""
STYLE = """
body{font:15px/1.45 system-ui,sans-serif;color:#222;margin:0 auto;max-width:1250px}
body{padding:16px}
h1{font-size:22px;margin:0 0 6px}h2{font-size:17px;margin:26px 0 6px}
p{margin:4px 0}
table{border-collapse:collapse}td,th{padding:2px 12px 2px 0;text-align:right;font-weight:400}
th{color:#666;border-bottom:1px solid #ccc}td:first-child,th:first-child{text-align:left}
.room{display:grid;grid-template-columns:repeat(auto-fill,minmax(360px,1fr));gap:14px}
.quiet{color:#666;font-size:13px}.dot{display:inline-block;width:11px;height:11px;margin-right:5px}
.dot{border-radius:6px}svg{width:100%}.title{font-size:13px}
.axis{font-size:11px;text-anchor:middle;fill:#555}
.tick{font-size:10px;text-anchor:middle;fill:#777}.end{text-anchor:end}.grid{stroke:#e5e5e5}
"""


EDGE_HEAD = ["edges", "in the paper", "here"]


def main_ways(results: Record) -> tuple[dict[str, Record], dict[str, Record]]:
    """The ways of the main table, and those of the table of parts."""
    parts = {way.name for way in ABLATIONS}
    ways: dict[str, Record] = results["ways"]
    main = {name: way for name, way in ways.items() if name not in parts}
    return main, {name: way for name, way in ways.items() if name in parts}


def main_rows(ways: dict[str, Record]) -> list[list[str]]:
    """The main table: a row a figure, a column a way; the paper's own figures first."""
    rows = []
    for name, cell in _CELLS.items():
        rows.append([name, IN_PAPER.get(name, ""), *(cell(way) for way in ways.values())])
    return rows


ABLATION_HEAD = [
    "", "edit ratio, median", "mean of quartiles", "support", "leader", "side branch",
    "leaders of shown", "side branches of shown", "CPU s",
]  # fmt: skip


def ablation_rows(ways: dict[str, Record]) -> list[list[str]]:
    """What each part brings and costs: a row a way."""
    about = {way.name: way.about for way in (*WAYS, *ABLATIONS)}
    rows = []
    for name, way in ways.items():
        quartiles = way["edit_ratio"]["quartiles"]
        rows.append(
            [
                f"{name}: {about[name]}",
                _number(way["edit_ratio"]["median"]),
                _number(sum(quartiles) / 2 if quartiles else None),
                *(
                    _number(way["labels"][word]["median"])
                    for word in ("support", "leader", "side_branch")
                ),
                _percent(way["leaders_found_of_shown"]),
                _percent(way["side_branches_found_of_shown"]),
                _number(way["cpu_s"]["median"]),
            ]
        )
    return rows


def habit_rows(ways: dict[str, Record]) -> list[list[str]]:
    """Median edit ratio of the trees with each habit, by way."""
    rows = []
    for habit in HABITS:
        trees = next(iter(ways.values()))["habits"][habit]["trees"]
        cells = [_number(way["habits"][habit]["edit_ratio"]) for way in ways.values()]
        rows.append([f"{habit} ({trees} trees)", *cells])
    return rows


def edge_rows(edges: dict[str, Any]) -> list[list[str]]:
    """The paper's two tables of edge confidence: its own figures, and its network here."""
    rows = []
    for key in ("validity_accuracy", "category_accuracy", "calibration_error"):
        in_paper: Any = PAPER.get(key)
        rows.append([key.replace("_", " "), _percent(in_paper), _percent(edges[key])])
    for key in ("valid", "invalid", *(label.word for label in Label), "other"):
        both: list[Any] = [PAPER[key], edges[key]]
        pairs = [" / ".join(_percent(value) for value in pair) for pair in both]
        rows.append([f"{key.replace('_', ' ')}: precision / recall", *pairs])
    return rows


def markdown(head: list[str], rows: list[list[str]]) -> list[str]:
    """A table as lines of Markdown."""
    lines = ["| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
    return lines + ["| " + " | ".join(row) + " |" for row in rows]


def html_page(results: Record, trials: list[Record]) -> str:
    """The page; needs no network."""
    ways, others = main_ways(results)
    by_way = {name: [t for t in trials if t["way"] == name] for name in SHOWN if name in ways}
    done = {name: [t for t in own if "error" not in t] for name, own in by_way.items()}
    timed = {name: [t for t in own if "cpu_s" in t] for name, own in done.items()}
    about = "".join(f"<li><b>{way.name}</b>: {way.about}</li>" for way in WAYS)
    labels = {name: by_label(own) for name, own in done.items()}
    figures = [
        histogram("Global edit ratio", {n: edit_ratios(own) for n, own in by_way.items()}),
        scatter(
            "Edit ratio against edges of the corrected skeleton", "edges", "edit ratio",
            {n: ([t["edits"]["edges"] for t in own], edit_ratios(own)) for n, own in done.items()},
        ),
        *(
            histogram(
                f"{label.word.replace('_', ' ')}: edit ratio",
                {name: found[label] for name, found in labels.items()},
            )
            for label in Label
        ),
        scatter(
            "Run time against superpoints", "superpoints", "CPU seconds",
            {n: ([t["superpoints"] for t in own], [t["cpu_s"]["total"] for t in own])
             for n, own in timed.items()},
        ),
        scatter(
            "Before the search and in all", "CPU seconds of all stages", "before the search",
            {n: ([all_stages(t) for t in own], [before(t) for t in own])
             for n, own in timed.items()},
        ),
    ]  # fmt: skip
    return f"""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>prunus experiment</title>
<style>{STYLE}</style></head><body>
<h1>How good the skeletons are</h1>
<p>{escape(results["about"])}</p><ul>{about}</ul>
{html_table(["", "in the paper", *ways], main_rows(ways))}
<p class="quiet">Median edit ratio by label: NaN where a corrected tree has none of it. Found: at
least 80 % of a true leader, 50 % of a side branch. Shown: of what the scan shows.</p>
<h2>Figures</h2>{legend(list(by_way))}
<div class="room">{"".join(f"<div>{f}</div>" for f in figures)}</div>
{_ablation(others | ways) if others else ""}
<h2>By habit of the tree: median edit ratio</h2>{html_table(["", *ways], habit_rows(ways))}
{_edges(results["edges"]) if results["edges"] else ""}
</body></html>
"""


def _edges(edges: Record) -> str:
    return "<h2>Edge confidence</h2>" + html_table(EDGE_HEAD, edge_rows(edges))


def _ablation(ways: dict[str, Record]) -> str:
    return "<h2>What each part brings</h2>" + html_table(ABLATION_HEAD, ablation_rows(ways))


def trials_csv(trials: list[Record]) -> bytes:
    """A row a trial: nested names are joined by dots."""
    return csv_bytes([_flat(trial) for trial in trials])


def _flat(record: Record, prefix: str = "") -> Record:
    found: Record = {}
    for name, value in record.items():
        if isinstance(value, dict):
            found |= _flat(value, f"{prefix}{name}.")
        else:
            found[prefix + name] = " ".join(value) if isinstance(value, list) else value
    return found


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.2f}"


def _percent(value: float | None) -> str:
    return "-" if value is None or value != value else f"{100 * value:.1f} %"


def _of_label(label: Label) -> Callable[[Record], str]:
    return lambda way: _number(way["labels"][label.word]["median"])


def _range(spread: Record, low: Any, high: Any) -> str:
    return f"{_number(low)} to {_number(high)}" if spread["number"] else "-"


def _centimetres(value: float | None) -> str:
    return _number(None if value is None else 100 * value)


_CELLS: dict[str, Callable[[Record], str]] = {
    "edit ratio, median": lambda w: _number(w["edit_ratio"]["median"]),
    "edit ratio, quartiles": lambda w: _range(w["edit_ratio"], *w["edit_ratio"]["quartiles"]),
    "edit ratio, best to worst": lambda w: _range(
        w["edit_ratio"], w["edit_ratio"]["least"], w["edit_ratio"]["most"]
    ),
    "edit ratio by length, median": lambda w: _number(w["by_length"]["median"]),
    "edit ratio by length, worst": lambda w: _number(w["by_length"]["most"]),
    "the same without labels, median": lambda w: _number(w["geometry_by_length"]["median"]),
    **{f"{label.word.replace('_', ' ')}, median": _of_label(label) for label in Label},
    "leaders found": lambda w: _percent(w["leaders_found"]),
    "leaders found, of those shown": lambda w: _percent(w["leaders_found_of_shown"]),
    "false leaders a tree": lambda w: _number(w["false_leaders"]),
    "side branches found, of those shown": lambda w: _percent(w["side_branches_found_of_shown"]),
    "false side branches a tree": lambda w: _number(w["false_side_branches"]),
    "right parent, of what was found": lambda w: _percent(w["parents_right"]),
    "supports that leave rightly": lambda w: _percent(w["supports_right"]),
    "base error, median [cm]": lambda w: _centimetres(w["base_error"]["median"]),
    "CPU seconds, median": lambda w: _number(w["cpu_s"]["median"]),
    "of it before the search": lambda w: _percent(w["cpu_before_search"]),
    "score, found": lambda w: _number(w["score_found"]),
    "score, corrected": lambda w: _number(w["score_of_corrected"]),
    "trials where the corrected scores less": lambda w: _percent(w["corrected_scores_less"]),
    "trials without a skeleton": lambda w: str(w["failed"]),
}
"""What the main table shows of a way."""
