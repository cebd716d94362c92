"""`prunus experiment`: run, sum up, write."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from prunus import __version__
from prunus.files.safely import write_bytes
from prunus.lab.experiment.edges import edge_measures
from prunus.lab.experiment.gold import corrected_in
from prunus.lab.experiment.orchard import Simulated, Subject
from prunus.lab.experiment.page import (
    ABLATION_HEAD,
    EDGE_HEAD,
    ablation_rows,
    edge_rows,
    habit_rows,
    html_page,
    main_rows,
    main_ways,
    markdown,
    trials_csv,
)  # fmt: skip
from prunus.lab.experiment.run import FIRST_SEED, run_trees
from prunus.lab.experiment.tables import summary
from prunus.lab.experiment.trial import BY_HAND, Record
from prunus.lab.simulate.settings import Setting

Watch = Callable[[Iterable[Record], str, int], Iterable[Record]]
"""Shows progress: items as they come, under a name, out of so many."""


@dataclass(frozen=True)
class Orchard:
    """The trees of an experiment, and what is to be said of them before all else."""

    trees: Sequence[Subject]
    about: str
    people: bool = False
    """Whether people corrected them."""

    @classmethod
    def simulated(cls, trees: int, setting: Setting, seed: int) -> Orchard:
        """So many simulated trees, from a seed on."""
        first = FIRST_SEED + seed
        own = [Simulated(number, setting) for number in range(first, first + trees)]
        return cls(
            own,
            f"{trees} simulated trees, scan = {setting}, seeds {first} to {first + trees - 1}. The "
            "points of the target alone, as a person leaves them; the corrections by a program "
            "that knows the tree.",
        )

    @classmethod
    def corrected(cls, folder: Path, scans: Path | None) -> Orchard:
        """The trees in the studio's work folder that are done."""
        own, in_work = corrected_in(folder, scans)
        left = f" Still in work, and left out: {', '.join(in_work)}." if in_work else ""
        return cls(own, f"{len(own)} trees corrected by people, {folder}.{left} {OWN}", people=True)


OWN = (
    f"The way '{BY_HAND}' is the machine's skeleton as the person found it: "
    "its edit ratio is the person's own. All other ways and draws have superpoints of their own: "
    "there a program makes the corrections, to whom the person's skeleton is the true tree. The "
    "points are those that the person left. People mend what is notably wrong and leave the rest "
    "as the machine drew it: that favours the way that they began from."
)


def experiment(
    folder: Path, orchard: Orchard, draws: int, ablation: bool, jobs: int, watch: Watch
) -> Record:
    """Run what is missing, then write index.html, results.json, results.md and trials.csv.

    Returns what `results.json` holds, save the trials: `about`, `ways`, `edges`.
    """
    count = len(orchard.trees)
    made = run_trees(folder, orchard.trees, draws, ablation, min(jobs, count))
    records = list(watch(made, "trees", count))
    trials = [trial for record in records for trial in record["trials"]]
    results: dict[str, Any] = {
        "about": f"{orchard.about} Draws of points a tree: {draws}; prunus {__version__}."
        + (_without(records) if orchard.people else ""),
        "ways": summary(trials),
        "edges": edge_measures(records),
    }
    write_bytes(folder / "results.json", json.dumps(results | {"trials": trials}).encode())
    write_bytes(folder / "results.md", ("\n".join(lines_of(results)) + "\n").encode())
    write_bytes(folder / "trials.csv", trials_csv(trials))
    write_bytes(folder / "index.html", html_page(results, trials).encode())
    return results


def _without(records: list[Record]) -> str:
    """Which trees have no edits of a person."""
    names = [
        record["tree"]
        for record in records
        if not any(trial["way"] == BY_HAND for trial in record["trials"])
    ]
    if not names:
        return ""
    return (
        f" Without '{BY_HAND}', since no skeleton.json on the same superpoints is beside it: "
        f"{', '.join(names)}."
    )


def lines_of(results: Record) -> list[str]:
    """The tables as lines of Markdown."""
    ways, others = main_ways(results)
    return [
        results["about"],
        "",
        *markdown(["", "in the paper", *ways], main_rows(ways)),
        "",
        *(markdown(ABLATION_HEAD, ablation_rows(others | ways)) if others else []),
        "",
        *markdown(["median edit ratio, trees with", *ways], habit_rows(ways)),
        "",
        *(markdown(EDGE_HEAD, edge_rows(results["edges"])) if results["edges"] else []),
    ]
