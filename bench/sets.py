"""`python -m bench.sets [--set NAME ...] [--method NAME ...]`: a table a set of trees.

Each set is of another kind of tree or scan, so that a claim stands for each apart; `measured` are
trees that people measured, for testing only (`--measured FOLDER`, see `bench.set_measured`).
Methods are `default`, `by_cost` (the same, but cost alone tells whose wood is), `paper`, or any
`module:function` that takes a `PointCloud` and a base or None. Cases are kept in the `--cache`
folder; a rerun costs only the methods.

A2 and geometry ratio: `prunus.lab.evaluate.by_length`. Found branches are of those that
the scan shows. Trees that are no UFO trees (in `any`) have no labels: geometry alone counts.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from bench.drawn_ufo import all_round
from bench.set_cases import SETS, Case, case_of
from bench.set_figures import Figures, figures_of, lines_of
from bench.set_measured import Measured, measured_figures, measured_in, measured_lines
from bench.set_methods import METHODS, Found, Method, method_of, tried
from prunus.model import Floats

MEASURED = "measured"
USUAL = [name for name in SETS if not name.endswith("_raw")]
Measure = Callable[[Any, "Found | None"], Figures]
Told = Callable[[list[Figures]], dict[str, str]]


def main() -> None:
    """Measure, and print a table a set as it is done."""
    chosen = parser_of("python -m bench.sets", ["default", "paper"]).parse_args()
    run(chosen, {name: method_of(name) for name in chosen.method}, USUAL, figures_of)


def parser_of(program: str, methods: list[str]) -> argparse.ArgumentParser:
    """What may be said of sets and methods, these methods unless others are named."""
    parser = argparse.ArgumentParser(prog=program)
    parser.add_argument("--set", nargs="+", choices=[*SETS, MEASURED], metavar="NAME",
                        help=f"of {', '.join([*SETS, MEASURED])}")  # fmt: skip
    parser.add_argument("--trees", type=int, help="so many a set")
    parser.add_argument("--seed", type=int, help="the first seed of each set")
    parser.add_argument("--method", nargs="+", default=methods, metavar="NAME",
                        help=f"of {', '.join(METHODS)}, or module:function")  # fmt: skip
    parser.add_argument("--base", action="store_true", help="give every method the true base")
    parser.add_argument("--cache", type=Path, help="the folder in which cases are kept")
    parser.add_argument("--measured", type=Path, help="the folder of measured trees")
    return parser


def run(
    chosen: argparse.Namespace, methods: dict[str, Method], usual: list[str], measure: Measure
) -> None:
    """A table a set, of the usual ones where none are chosen; `measure` is for simulated trees."""
    _warm(methods)
    for name in chosen.set or [*usual, *([MEASURED] if chosen.measured else [])]:
        if name == MEASURED:
            if chosen.measured is None:
                sys.exit("bench.sets: the set 'measured' needs --measured FOLDER")
            scans = measured_in(chosen.measured)[: chosen.trees]
            about = "trees that people measured, front and all round"
            _table(name, about, scans, methods, chosen.base, measured_figures, measured_lines)
        else:
            first = SETS[name].first if chosen.seed is None else chosen.seed
            seeds = range(first, first + (chosen.trees or SETS[name].trees))
            cases = (case_of(name, seed, chosen.cache) for seed in seeds)
            about = f"{SETS[name].about}; seeds {seeds[0]} to {seeds[-1]}"
            _table(name, about, cases, methods, chosen.base, measure, lines_of)


def _warm(methods: dict[str, Method]) -> None:
    """Each method once, untimed: what is compiled or loaded at first is no cost of a tree."""
    xyz = all_round(0).xyz[::5]
    for method in methods.values():
        tried(method, xyz, None)


def _table(
    name: str,
    about: str,
    cases: Iterator[Case] | list[Measured],
    methods: dict[str, Method],
    base: bool,
    measure: Measure,
    told: Told,
) -> None:
    records: dict[str, list[Figures]] = {method: [] for method in methods}
    for case in cases:
        for title, method in methods.items():
            found, spent = tried(method, case.xyz, _base_of(case) if base else None)
            records[title].append(measure(case, found) | {"cpu": spent})
            print(f"  {case.name} {title}: {_in_short(records[title][-1])}", file=sys.stderr)
    columns = {title: told(own) for title, own in records.items()}
    print(f"\n{name}: {about}{'; the base given' if base else ''}")
    # A row of which no method has anything says nothing.
    titles = next(iter(columns.values()))
    rows = [row for row in titles if any(own[row] != "-" for own in columns.values())]
    width = max(map(len, rows))
    print(f"{'':{width}}  " + "".join(f"{title:>32}" for title in columns))
    for row in rows:
        print(f"{row:{width}}  " + "".join(f"{own[row]:>32}" for own in columns.values()))
    sys.stdout.flush()


def _base_of(case: Case | Measured) -> Floats:
    return np.asarray(case.foot if isinstance(case, Measured) else case.truth.xyz[0])


def _in_short(figures: Figures) -> str:
    return "  ".join(f"{name} {value:.3f}" for name, value in figures.items())


if __name__ == "__main__":
    main()
