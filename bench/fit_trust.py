"""`python -m bench.fit_trust [--trees 60] [--seed 500000] [--write]`: how far to trust a skeleton.

Logistic regressions over what is known of the branches and edges that the chain finds on simulated
scans (see `bench.trust`), those among them of which the wrong tree was taken. A ridge keeps weights
small where there is little to learn from.
"""

from __future__ import annotations

import argparse

import numpy as np

from bench.trust import CASES, Tried, tried
from prunus.io.safely import write_bytes
from prunus.learn.logistic import fit_odds
from prunus.measure.trust import Model
from prunus.measure.trust.evidence import Evidence, of_branches, of_edges
from prunus.measure.trust.model import SHIPPED
from prunus.model import Label

RIDGE = 10.0
SIGNS = {"least": 1, "kind": 1, "rival": 1, "straight": 1, "touch": 1, "seen": 1, "bend": -1,
         "raw": -1, "edge": 1, "branch": 1}  # fmt: skip
"""What speaks for a branch or an edge, and what against."""
APART = 1000
"""The cases have seeds so far apart."""


def fitted(some: list[Tried]) -> Model:
    """The model of some trees: the branches first, then the edges, given those."""
    told = [of_branches(one.known) for one in some]
    label = np.concatenate([one.label for one in some])
    right = np.concatenate([one.right for one in some])
    flat = [evidence for branches in told for evidence in branches]
    branch = {}
    for kind in Label:
        own = np.flatnonzero(label == kind)
        branch[kind] = fit_odds([flat[row] for row in own], right[own], RIDGE, SIGNS)
    edges: list[Evidence] = []
    for one, evidence in zip(some, told, strict=True):
        pairs = zip(one.label.tolist(), evidence, strict=True)
        trust = np.array([branch[Label(kind)](known) for kind, known in pairs])
        edges += of_edges(one.known, trust)
    return Model(
        branch, fit_odds(edges, np.concatenate([one.unchanged for one in some]), RIDGE, SIGNS)
    )


def main() -> None:
    """Fit, print, and with `--write` put the model in place."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--trees", type=int, default=60)
    parser.add_argument("--seed", type=int, default=500_000)
    parser.add_argument("--write", action="store_true")
    chosen = parser.parse_args()
    some = []
    for number, case in enumerate(CASES):
        first = chosen.seed + APART * number
        found = [tried(seed, *case) for seed in range(first, first + chosen.trees)]
        some += [one for one in found if one is not None]
        print(f"{case}: {len(some)} trees so far", flush=True)
    model = fitted(some)
    print(model.to_toml())
    if chosen.write:
        write_bytes(SHIPPED, model.to_toml().encode())


if __name__ == "__main__":
    main()
