"""`prunus experiment`: run, sum up, write."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from prunus import __version__
from prunus.experiment.edges import edge_measures
from prunus.experiment.page import (
    ABLATION_HEAD,
    ablation_rows,
    edge_rows,
    habit_rows,
    html_page,
    main_rows,
    markdown,
    trials_csv,
)  # fmt: skip
from prunus.experiment.run import FIRST_SEED, run_trees
from prunus.experiment.tables import summary
from prunus.experiment.trial import WAYS, Record
from prunus.io.safely import write_bytes
from prunus.simulate.settings import Setting

Watch = Callable[[Iterable[Record], str, int], Iterable[Record]]
"""Shows progress: items as they come, under a name, out of so many."""


def experiment(
    folder: Path,
    trees: int,
    draws: int,
    setting: Setting,
    seed: int,
    ablation: bool,
    jobs: int,
    watch: Watch,
) -> Record:
    """Run what is missing, then write index.html, results.json, results.md and trials.csv.

    Returns what `results.json` holds, save the trials: `about`, `ways`, `edges`.
    """
    seeds = range(FIRST_SEED + seed, FIRST_SEED + seed + trees)
    records = list(watch(run_trees(folder, seeds, draws, setting, ablation, jobs), "trees", trees))
    trials = [trial for record in records for trial in record["trials"]]
    results: dict[str, Any] = {
        "about": (
            f"{trees} trees x {draws} draws of points, scan = {setting}, seeds {seeds[0]} "
            f"to {seeds[-1]}, prunus {__version__}. The points of the target alone, as a person "
            "leaves them; the corrections by a program that knows the tree."
        ),
        "ways": summary(trials),
        "edges": edge_measures(records),
    }
    write_bytes(folder / "results.json", json.dumps(results | {"trials": trials}).encode())
    write_bytes(folder / "results.md", ("\n".join(lines_of(results)) + "\n").encode())
    write_bytes(folder / "trials.csv", trials_csv(trials))
    write_bytes(folder / "index.html", html_page(results, trials).encode())
    return results


def lines_of(results: Record) -> list[str]:
    """The tables as lines of Markdown."""
    ways = {way.name: results["ways"][way.name] for way in WAYS}
    others = {name: way for name, way in results["ways"].items() if name not in ways}
    return [
        results["about"],
        "",
        *markdown(["", "in the paper", *ways], main_rows(ways)),
        "",
        *(markdown(ABLATION_HEAD, ablation_rows(others | ways)) if others else []),
        "",
        *markdown(["median edit ratio, trees with", *ways], habit_rows(ways)),
        "",
        *markdown(
            ["edges", "in the paper", "paper's network", "ours"], edge_rows(results["edges"])
        ),
    ]
