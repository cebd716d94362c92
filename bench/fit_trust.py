"""`python -m bench.fit_trust --cache FOLDER [--trees 24] [--others 3] [--write]`: trust, anew.

Logistic regressions over what is known of the branches and edges that the chain finds on simulated
scans (`bench.trust_cases`), and, of trees as a whole, whether they are the tree that is meant,
bare wood, and of the form that was learned; for those also over drawn clouds of what is no tree,
and of trees of other forms. A ridge keeps weights small where there is little to learn from.
What was done is kept in the folder: begun again, it goes on.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from bench.trust_cases import FORMS, KINDS, SETS, Tried, all_tried
from prunus.files.safely import write_bytes
from prunus.lab.learn.edges.logistic import fit_odds
from prunus.model import Ints, Label
from prunus.model.branches import branches
from prunus.trust import Model, Parts
from prunus.trust.evidence import Evidence, of_branches, of_edges, of_tree
from prunus.trust.model import SHIPPED
from prunus.trust.odds import Odds

RIDGE = 10.0
RIDGE_WHOLE = 1.0
SIGNS = {"least": 1, "mean": 1, "kind": 1, "rival": 1, "wood": 1, "way": 1, "straight": 1,
         "beside": -1, "scatter": -1, "unclear": -1, "explained": 1, "edge": 1, "branch": 1,
         "lead": 1, "sure": 1, "astray": -1, "loose": -1, "around": -1}  # fmt: skip
"""What speaks for a branch, an edge or a tree, and what against."""
WHOLE = {
    "meant": ("lead",),
    "wood": ("astray", "unclear", "around"),
    "form": ("unclear", "frame", "fruit"),
}
"""What tells of the whole tree."""
MOST_BRANCHES, MOST_EDGES = 200, 1000
"""No tree has more weight than so many of its branches of a label, or of its edges."""


def fitted(some: list[Tried]) -> Model:
    """The model of what came of some scans."""
    whole = {name: _whole(name, some) for name in WHOLE}
    told = [one for one in some if one.meant and one.known and len(one.right)]
    form = [whole["form"](of_tree(one.known)) for one in told if one.known]
    return Model(_parts(told, form), whole)


def _whole(name: str, some: list[Tried]) -> Odds:
    asked = [one for one in some if one.known and (one.name in SETS or name != "meant")]
    evidence = [_only(WHOLE[name], of_tree(one.known)) for one in asked if one.known]
    right = np.array([getattr(one, name) for one in asked])
    return fit_odds(evidence, right, RIDGE_WHOLE, SIGNS)


def _only(names: tuple[str, ...], evidence: Evidence) -> Evidence:
    return {name: evidence[name] for name in names}


def _parts(some: list[Tried], form: list[float]) -> Parts:
    """The model of branches first, then that of edges, given those; form: of each tree."""
    rng = np.random.default_rng(0)
    told = [of_branches(one.known, known) for one, known in zip(some, form, strict=True)
            if one.known]  # fmt: skip
    label = [_labels(one) for one in some]
    branch = {}
    for kind in Label:
        rows = [_some(rng, np.flatnonzero(own == kind), MOST_BRANCHES) for own in label]
        evidence = [known[row] for known, own in zip(told, rows, strict=True) for row in own]
        right = [one.right[own] for one, own in zip(some, rows, strict=True)]
        branch[kind] = fit_odds(evidence, np.concatenate(right), RIDGE, SIGNS)
    edges: list[Evidence] = []
    unchanged = []
    for one, known, own, likely in zip(some, told, label, form, strict=True):
        pairs = zip(own.tolist(), known, strict=True)
        trust = np.array([branch[Label(kind)](said) for kind, said in pairs])
        every = of_edges(one.known, trust, likely) if one.known else []
        taken = _some(rng, np.arange(len(every)), MOST_EDGES)
        edges += [every[row] for row in taken]
        unchanged.append(one.unchanged[taken])
    return Parts(branch, fit_odds(edges, np.concatenate(unchanged), RIDGE, SIGNS))


def _labels(one: Tried) -> Ints:
    found = branches(one.known.skeleton) if one.known else []
    return np.array([int(branch.label) for branch in found], np.int64)


def _some(rng: np.random.Generator, rows: Ints, most: int) -> Ints:
    return rows if len(rows) <= most else rng.choice(rows, most, replace=False)


def examples(trees: int, others: int, cache: Path) -> Iterator[Tried]:
    """What the models are fitted to; said as it comes."""
    for names, count in ((tuple(SETS), trees), (FORMS, others), (KINDS, others)):
        for name in names:
            some = list(all_tried(name, count, cache))
            print(f"{name}: {sum(one.known is not None for one in some)} of {count}", flush=True)
            yield from some


def main() -> None:
    """Fit, print, and with `--write` put the model in place."""
    parser = argparse.ArgumentParser(prog="python -m bench.fit_trust")
    parser.add_argument("--trees", type=int, default=24, help="of each set")
    parser.add_argument("--others", type=int, default=3, help="of each other form and kind")
    parser.add_argument("--cache", type=Path, required=True, help="the folder of what was done")
    parser.add_argument("--write", action="store_true")
    chosen = parser.parse_args()
    model = fitted(list(examples(chosen.trees, chosen.others, chosen.cache)))
    print(model.to_toml())
    if chosen.write:
        write_bytes(SHIPPED, model.to_toml().encode())


if __name__ == "__main__":
    main()
