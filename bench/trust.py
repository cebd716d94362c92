"""`python -m bench.trust [--trees 40] [--seed 980000]`: is a trust of 90 % right nine times of ten.

Of simulated scans never used for fitting, field scans raw and by the tree alone with its base, and
clean ones raw: the expected calibration error of the trust in branches and in edges, the trust in
the tree against the share of its edges that needs no correction, and what `review` sends to a
person. A scan of which the wrong tree was taken has no right branch, and counts.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from prunus.errors import PrunusError
from prunus.evaluate.correction import corrected
from prunus.evaluate.edits import edits, unchanged
from prunus.evaluate.right import right_branches
from prunus.experiment.orchard import Tree, tree_of
from prunus.learn.tables import calibration_error
from prunus.measure import branches
from prunus.measure.trust import Known
from prunus.model import Bools, Floats, Ints
from prunus.params import Parameters
from prunus.pipeline import skeletonize
from prunus.result import Result
from prunus.search import shipped_score
from prunus.search.judged import judged
from prunus.simulate.scan import simulate_scan
from prunus.simulate.settings import Setting

CASES: tuple[tuple[Setting, bool], ...] = (("hard", True), ("hard", False), ("clean", True))
"""Settings, and whether the scan is given raw, with no base."""


@dataclass(frozen=True, eq=False)
class Tried:
    """A skeleton and what came of it: right (B,) its branches, unchanged (M - 1,) its edges."""

    result: Result
    right: Bools
    unchanged: Bools
    ratio: float
    seconds: float

    @property
    def label(self) -> Ints:
        """The label (B,) of each branch."""
        return np.array([int(one.label) for one in branches(self.result.in_house)], np.int64)

    @property
    def known(self) -> Known:
        """All that is known of the skeleton."""
        result = self.result
        told = judged(result.in_house, result.graph, shipped_score())
        raw = result.isolated is not None
        return Known(result.in_house, result.refined, told.gain, told.likely, raw)


def tried(seed: int, setting: Setting, raw: bool) -> Tried | None:
    """The chain on the scan of that seed; None where it finds no tree of two edges."""
    tree = tree_of(seed, setting)
    try:
        result = _raw(seed, setting) if raw else _alone(tree)
    except PrunusError:
        return None
    if len(result.in_house) < 3:
        return None
    _ = result.refined
    cpu = time.process_time()
    _ = result.trust
    cpu = time.process_time() - cpu
    nodes = result.graph.superpoints.cloud.to_input.apply(result.graph.xyz)
    star = corrected(result.skeleton, nodes, tree.truth, tree.counts)
    return Tried(
        result,
        right_branches(result.skeleton, tree.truth),
        unchanged(result.skeleton, star),
        edits(result.skeleton, star).ratio,
        cpu,
    )


def _raw(seed: int, setting: Setting) -> Result:
    return skeletonize(simulate_scan(seed, setting).xyz)


def _alone(tree: Tree) -> Result:
    params = Parameters().changed("isolation", isolate="never")
    return skeletonize(tree.cloud, tree.truth.xyz[0], params)


def lines_of(some: list[Tried]) -> Iterator[str]:
    """What is printed of them."""
    trusts = [one.result.trust for one in some]
    known = [(one, trust) for one, trust in zip(some, trusts, strict=True) if trust is not None]
    label = np.concatenate([one.label for one, _ in known])
    branch = np.concatenate([trust.branch for _, trust in known])
    right = np.concatenate([one.right for one, _ in known])
    yield _calibrated("branches", branch, right)
    for number, name in enumerate(("trunk", "support", "leader", "side branch")):
        yield _calibrated(f"  {name}", branch[label == number], right[label == number])
    edge = np.concatenate([trust.edge[1:] for _, trust in known])
    yield _calibrated("edges", edge, np.concatenate([one.unchanged for one, _ in known]))
    tree = np.array([trust.tree for _, trust in known])
    share = np.array([one.unchanged.mean() for one, _ in known])
    ratio = np.array([one.ratio for one, _ in known])
    yield (f"  trees: trust {tree.mean():.3f}, unchanged {share.mean():.3f}, off by "
           f"{np.abs(tree - share).mean():.3f} in the mean, correlation "
           f"{np.corrcoef(tree, share)[0, 1]:.2f}")  # fmt: skip
    looks = np.array([bool(one.result.review) for one, _ in known])
    for name, part in (("for a person", looks), ("not", ~looks)):
        worst = np.nanquantile(ratio[part], (0.5, 0.9, 1)) if part.any() else np.full(3, np.nan)
        yield (f"  {name}: {part.sum()} trees, edit ratio median {worst[0]:.2f}, "
               f"90 % {worst[1]:.2f}, worst {worst[2]:.2f}")  # fmt: skip
    yield f"  CPU: {np.mean([one.seconds for one in some]):.3f} s a tree"


def _calibrated(name: str, guess: Floats, right: Bools) -> str:
    sure = guess >= 0.9
    share = f"{right[sure].mean():.1%}" if sure.any() else "-"
    return (f"  {name}: {len(guess)}, right {right.mean():.3f}, calibration error "
            f"{calibration_error(guess, right):.3f}; {sure.sum()} of 90 % and more, "
            f"{share} of them right")  # fmt: skip


def main() -> None:
    """Measure, and print."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--trees", type=int, default=40)
    parser.add_argument("--seed", type=int, default=980_000)
    chosen = parser.parse_args()
    everything = []
    for setting, raw in CASES:
        seeds = range(chosen.seed, chosen.seed + chosen.trees)
        some = [one for seed in seeds if (one := tried(seed, setting, raw)) is not None]
        everything += some
        print(f"== {setting}, {'raw' if raw else 'the tree alone, with its base'}: {len(some)} "
              f"of {chosen.trees} give a tree")  # fmt: skip
        print("\n".join(lines_of(some)), flush=True)
    print("== all")
    print("\n".join(lines_of(everything)))


if __name__ == "__main__":
    main()
