"""`python -m bench.fit_cuts [--trees 120] [--seed 500000] [--write]`: the confidence of cuts.

Logistic regressions over the evidence of what the rules cut on what the chain makes of simulated
scans, hard and clean: right is a cut on a branch of which the rules ask for one on the true tree,
or that comes down with another, at most 3 cm off. Prints, with each tree judged by a model that has
not seen it, how many cuts of side branches a limit lets through on hard scans and on clean ones,
and how many of them are wrong.
"""

from __future__ import annotations

import argparse

import numpy as np

from bench.cuts import Judged, outcomes
from prunus.cuts import shipped_rules
from prunus.cuts.confidence import SHIPPED, features
from prunus.files.safely import write_bytes
from prunus.lab.learn.edges.logistic import fit_odds
from prunus.lab.simulate.settings import Setting
from prunus.model import Bools, Ints

OFF = 0.03
"""A cut that is farther off along its branch is not right here, metres."""
SETTINGS: tuple[Setting, ...] = ("hard", "clean")
FOLDS = 8
Told = dict[str, float]
LIMITS = (0.5, 0.6, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95)


def is_right(one: Judged) -> bool:
    """Whether a cut is one to be confident in."""
    return one.word == "needless" or (one.word == "right" and abs(one.off) <= OFF)


def report(told: list[Told], right: Bools, tree: Ints, clear: Bools, hard: Bools) -> None:
    """Print what each limit lets through of cuts (C,), and of those that are `clear` else."""
    guess = np.zeros(len(right))
    for fold in range(FOLDS):
        left = np.flatnonzero(tree % FOLDS == fold)
        others = np.flatnonzero(tree % FOLDS != fold)
        odds = fit_odds([told[row] for row in others], right[others])
        guess[left] = [odds(told[row]) for row in left]
    for setting, own in (("hard", hard), ("clean", ~hard)):
        print(f"{setting}: {own.sum()} cuts, {right[own].mean():.1%} right")
        for limit in LIMITS:
            over = own & (guess >= limit)
            told_of = (f"{name} {some.sum()} ({some.sum() / own.sum():.0%}), "
                       f"{(~right[some]).mean():.1%} wrong"
                       for name, some in (("all", over), ("no other doubt", clear & over))
                       if some.any())  # fmt: skip
            print(f"  over {limit:.2f}: {'; '.join(told_of)}")


def main() -> None:
    """Fit, print, and with `--write` put the model in place."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--trees", type=int, default=120)
    parser.add_argument("--seed", type=int, default=500_000)
    parser.add_argument("--write", action="store_true")
    chosen = parser.parse_args()
    seeds = range(chosen.seed, chosen.seed + chosen.trees)
    rules, settings = shipped_rules(), SETTINGS
    cuts = {s: [(n, one) for n in seeds for one in outcomes(n, s, rules)[0].planned]
            for s in settings}  # fmt: skip
    text = written(cuts["hard"], cuts["clean"])
    print(text)
    if chosen.write:
        write_bytes(SHIPPED, text.encode())


def written(hard: list[tuple[int, Judged]], clean: list[tuple[int, Judged]]) -> str:
    """The file of the models, from planned cuts and the seeds of their trees."""
    made = "# The confidence in cuts, made by `python -m bench.fit_cuts`."
    every = [*hard, *clean]
    shoots = [(tree, one) for tree, one in every if one.cut.rule == "side_branches"]
    of_hard = sum(one.cut.rule == "side_branches" for _, one in hard)
    told, right = _told([one for _, one in shoots])
    clear = [
        not [r for r in one.cut.reasons if not r.startswith("confidence")] for _, one in shoots
    ]
    trees = np.array([tree for tree, _ in shoots])
    report(told, right, trees, np.array(clear), np.arange(len(shoots)) < of_hard)
    lines = fit_odds(told, right).lines("side_branches")
    told, right = _told([one for _, one in every if one.cut.rule == "spacing"])
    print(f"{len(right)} cuts through leaders, {right.mean():.1%} right")
    leaders = fit_odds([{"likely": one["likely"]} for one in told], right)
    return "\n".join([made, *lines, *leaders.lines("leaders")]) + "\n"


def _told(cuts: list[Judged]) -> tuple[list[Told], Bools]:
    """The features of cuts, and which (C,) are right."""
    return [features(one.cut.evidence) for one in cuts], np.array([is_right(one) for one in cuts])


if __name__ == "__main__":
    main()
