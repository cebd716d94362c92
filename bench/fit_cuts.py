"""`python -m bench.fit_cuts [--trees 120] [--seed 500000] [--write]`: the confidence of cuts.

A logistic regression over the evidence of the side branches that the rules cut on what the chain
makes of simulated field scans: right is a cut on a branch of which the rules ask for one on the
true tree, or that comes down with another, at most 3 cm off. Prints, with each tree judged by a
model that has not seen it, how many cuts a limit lets through and how many of them are wrong.
"""

from __future__ import annotations

import argparse

import numpy as np

from bench.cuts import Judged, outcomes
from prunus.io.safely import write_bytes
from prunus.learn.logistic import fit_logistic
from prunus.measure.cuts import shipped_rules
from prunus.measure.cuts.confidence import SHIPPED, Model, features
from prunus.model import Bools, Floats, Ints

OFF = 0.03
"""A cut that is farther off along its branch is not right here, metres."""
FOLDS = 8
LIMITS = (0.5, 0.7, 0.8, 0.85, 0.9, 0.91, 0.92, 0.93, 0.94, 0.945, 0.95, 0.955, 0.96, 0.97)


def is_right(one: Judged) -> bool:
    """Whether a cut is one to be confident in."""
    return one.word == "needless" or (one.word == "right" and abs(one.off) <= OFF)


def fitted(values: Floats, names: list[str], right: Bools) -> Model:
    """The model of some features (C, F)."""
    usual = np.nanmean(values, axis=0)
    scale = np.nanstd(values, axis=0)
    known = np.where(np.isfinite(values), (values - usual) / scale, 0.0)
    weights = fit_logistic(known, right)
    weight = dict(zip(names, (weights[:-1] / scale).tolist(), strict=True))
    return Model(float(weights[-1]), weight, dict(zip(names, usual.tolist(), strict=True)))


def guessed(model: Model, values: Floats, names: list[str]) -> Floats:
    """The probabilities (C,) that a model gives."""
    weight, usual = (np.array([part[n] for n in names]) for part in (model.weight, model.usual))
    odds = np.nansum((values - usual) * weight, axis=1) + model.offset
    return np.asarray(1 / (1 + np.exp(-odds)))


def report(values: Floats, names: list[str], right: Bools, tree: Ints, clear: Bools) -> None:
    """Print what each limit lets through of cuts that nothing else speaks against (C,)."""
    guess = np.zeros(len(right))
    for fold in range(FOLDS):
        held = tree % FOLDS == fold
        guess[held] = guessed(fitted(values[~held], names, right[~held]), values[held], names)
    print(f"{len(right)} cuts, {right.mean():.1%} right; {clear.mean():.0%} have no other doubt")
    for limit in LIMITS:
        for name, some in (("all", guess >= limit), ("no other doubt", clear & (guess >= limit))):
            wrong = int((~right[some]).sum())
            print(f"  over {limit:.2f}, {name}: {some.sum()} cuts ({some.mean():.0%}), {wrong} "
                  f"wrong ({wrong / max(some.sum(), 1):.1%})")  # fmt: skip


def main() -> None:
    """Fit, print, and with `--write` put the model in place."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--trees", type=int, default=120)
    parser.add_argument("--seed", type=int, default=500_000)
    parser.add_argument("--write", action="store_true")
    chosen = parser.parse_args()
    rows, right, tree, clear = [], [], [], []
    for seed in range(chosen.seed, chosen.seed + chosen.trees):
        for one in outcomes(seed, "field", shipped_rules())[0].planned:
            if one.cut.rule != "side_branches":
                continue
            rows.append(features(one.cut.evidence))
            right.append(is_right(one))
            tree.append(seed)
            clear.append(not [r for r in one.cut.reasons if not r.startswith("confidence")])
    names = list(rows[0])
    values = np.array([[row[name] for name in names] for row in rows])
    report(values, names, np.array(right), np.array(tree), np.array(clear))
    model = fitted(values, names, np.array(right))
    print(model.to_toml())
    if chosen.write:
        write_bytes(SHIPPED, model.to_toml().encode())


if __name__ == "__main__":
    main()
