"""`python -m bench.trust --cache FOLDER [--trees 12] [--others 3]`: is 90 % right 9 times of 10.

Of simulated scans never used for fitting, set by set: the expected calibration error of the trust
in branches and in edges, the trust in the tree against the share of its edges that is right, and
what `review` sends to a person. A scan of which another tree was taken has no right branch, and
counts. Then of fruit trees of other training forms, and of what is none: how much trust they get,
how many are refused, and how many are trusted with nothing said. What was done is kept.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from bench.trust_cases import FORMS, HELD_OUT, KINDS, SETS, Tried, all_tried
from prunus.frames.plausible import LEAST_WOOD
from prunus.lab.learn.edges.tables import calibration_error
from prunus.model import Bools, Floats, Label
from prunus.model.branches import Branch, branches
from prunus.trust import WOOD, Trust, trust_in
from prunus.trust.review import FORM, MEANT, review_of, whole_review

Pair = tuple[Tried, Trust]


def trusted(some: Iterable[Tried]) -> list[Pair]:
    """Those of which anything is known, with the trust in them."""
    return [(one, trust_in(one.known)) for one in some if one.known is not None]


def lines_of(some: list[Pair]) -> Iterator[str]:
    """What is printed of simulated scans."""
    branch = np.concatenate([trust.branch for _, trust in some])
    right = np.concatenate([one.right for one, _ in some])
    label = np.array([int(found.label) for one, _ in some for found in _found(one)])
    yield _calibrated("branches", branch, right)
    for kind in Label:
        yield _calibrated(f"  {kind.word}", branch[label == kind], right[label == kind])
    edge = np.concatenate([trust.edge[1:] for _, trust in some])
    yield _calibrated("edges", edge, np.concatenate([one.unchanged for one, _ in some]))
    tree = np.array([trust.tree for _, trust in some])
    share = np.array([one.unchanged.mean() for one, _ in some])
    yield (f"  trees: trust {tree.mean():.3f}, right {share.mean():.3f}, off by "
           f"{np.abs(tree - share).mean():.3f} in the mean, correlation "
           f"{np.corrcoef(tree, share)[0, 1]:.2f}")  # fmt: skip
    looks = np.array([bool(review_of(one.known.skeleton, trust))
                      for one, trust in some if one.known])  # fmt: skip
    for name, part in (("for a person", looks), ("not", ~looks)):
        least = np.quantile(share[part], (0, 0.1, 0.5)) if part.any() else np.full(3, np.nan)
        yield (f"  {name}: {part.sum()} trees, right at worst {least[0]:.2f}, "
               f"10 % {least[1]:.2f}, median {least[2]:.2f}")  # fmt: skip
    yield f"  said of the whole of UFO trees: {_said([p for p in some if p[0].form])}"


def _found(one: Tried) -> list[Branch]:
    return [] if one.known is None else branches(one.known.skeleton)


def _calibrated(name: str, guess: Floats, right: Bools) -> str:
    sure = guess >= 0.9
    share = f"{right[sure].mean():.1%}" if sure.any() else "-"
    if len(guess) == 0:
        return f"  {name}: none"
    return (f"  {name}: {len(guess)}, right {right.mean():.3f}, trust {guess.mean():.3f}, "
            f"calibration error {calibration_error(guess, right):.3f}; {sure.sum()} of 90 % and "
            f"more, {share} of them right")  # fmt: skip


def _said(some: list[Pair]) -> str:
    """How many are said to be of doubtful meaning, wood or form."""
    below = {"another tree": ("meant", MEANT), "no bare tree": ("wood", WOOD),
             "another form": ("form", FORM)}  # fmt: skip
    said = [f"{sum(getattr(trust, name) < limit for _, trust in some)} {word}"
            for word, (name, limit) in below.items()]  # fmt: skip
    return f"{', '.join(said)}, of {len(some)}"


def line_of_kind(name: str, some: list[Tried]) -> str:
    """What is printed of a kind that is not ours."""
    known = trusted(some)
    refused = len(some) - len(known) + sum(trust.wood < LEAST_WOOD for _, trust in known)
    left = [(one, trust) for one, trust in known if trust.wood >= LEAST_WOOD]
    said = sum(bool(whole_review(trust)) for _, trust in left)
    sent = sum(bool(review_of(one.known.skeleton, trust)) for one, trust in left if one.known)
    most = max((trust.tree for _, trust in left), default=0.0)
    return (f"  {name}: {len(some)}, {refused} refused, {said} said to be of another kind, "
            f"{sent - said} else sent to a person, {len(left) - sent} in silence; trust at most "
            f"{most:.2f}")  # fmt: skip


def main() -> None:
    """Measure, and print."""
    parser = argparse.ArgumentParser(prog="python -m bench.trust")
    parser.add_argument("--trees", type=int, default=12, help="of each set")
    parser.add_argument("--others", type=int, default=3, help="of each other form and kind")
    parser.add_argument("--cache", type=Path, required=True, help="the folder of what was done")
    chosen = parser.parse_args()
    every: list[Pair] = []
    for name in SETS:
        some = trusted(all_tried(name, chosen.trees, chosen.cache, HELD_OUT))
        every += some
        print(f"== {name}: {len(some)} of {chosen.trees} give a tree")
        print("\n".join(lines_of(some)), flush=True)
    print("== all")
    print("\n".join(lines_of(every)))
    for title, names in (("other forms", FORMS), ("no trees", KINDS)):
        print(f"== {title}")
        for name in names:
            tried = list(all_tried(name, chosen.others, chosen.cache, HELD_OUT))
            print(line_of_kind(name, tried), flush=True)


if __name__ == "__main__":
    main()
