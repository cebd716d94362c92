"""`python -m bench.cuts [--trees 20] [--seed 970000] [--rules FILE] [--why]`: plans and true trees.

The rules ask for cuts on the true tree, as far as the scan shows it, and on what the chain makes of
the scan, refined; and on the true topology, made rough and refined, to see what the lines alone
cost. A planned cut is right where the rules ask for one on the same true branch, whether or not the
scan shows all of it, and needless where that wood comes down with another cut. It is in place
within 15 mm along the branch.

The views of a field scan stand together some mm wrong, and so does the whole cloud: `in the scan's
place` judges by the true tree where the views show it, on average (see bench.refine). `--why` says
what came of the cuts that were asked for and are not in place.
"""

from __future__ import annotations

import argparse
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from bench.refine import as_shown, thinned
from prunus.cuts import Cut, CutRules, Plan, plan_cuts, shipped_rules
from prunus.cuts.limbs import Limb, Limbs
from prunus.geometry.near import away_from
from prunus.lab.evaluate.seen import shown
from prunus.lab.experiment.orchard import Tree, tree_of
from prunus.lab.simulate.scan import simulate_scan
from prunus.lab.simulate.settings import Setting
from prunus.model import Floats, Label, Skeleton
from prunus.params import Parameters
from prunus.pipeline import skeletonize
from prunus.refine.refined import Refined, refined

IN_PLACE = 0.015
"""A cut is in place so near to the true one along the branch, metres."""
BESIDE = 0.025
"""A cut is on a branch whose axis is so near, metres: the views of a scan differ by several mm."""
BLADE = 0.012
"""A blade cuts what has its bark so near, metres."""


@dataclass(frozen=True)
class Judged:
    """A planned cut, what came of it, and how far along the branch it is off, metres.

    `word`: right; needless, where the wood comes down with another cut; or wrong, on what: leader,
    support, trunk, side_branch, nothing.
    """

    cut: Cut
    word: str
    off: float


@dataclass(frozen=True)
class Outcome:
    """The plan of one tree: demanded cuts that the scan shows, and which planned cut met each.

    `middle` (D, 3) are the middles of the branches that these cut; `limbs` those of the plan;
    `best` how many the demanded cuts themselves would meet: what the scan hides may alter what the
    rules ask for on the whole tree.
    """

    demanded: tuple[Cut, ...]
    met: tuple[Judged | None, ...]
    planned: tuple[Judged, ...]
    plan: Plan
    seconds: float
    middle: Floats
    limbs: Limbs
    best: int

    @property
    def in_place(self) -> list[bool]:
        """Which of the demanded cuts are planned in place."""
        return [one is not None and abs(one.off) <= IN_PLACE for one in self.met]


def outcomes(
    seed: int, setting: Setting, rules: CutRules, topology: str = "chain"
) -> tuple[Outcome, Outcome]:
    """Plan the cuts of the scan of that seed: judged by the true tree, and in the scan's place."""
    tree, scan = tree_of(seed, setting), simulate_scan(seed, setting)
    fine = _chain(tree) if topology == "chain" else _true(tree, seed)
    points = tree.cloud.to_input.inverse().apply(scan.xyz)
    before = time.process_time()
    plan = plan_cuts(fine, points, rules)
    spent = time.process_time() - before
    limbs = Limbs.of(fine.skeleton, fine.names)
    true, place = tree, replace(tree, truth=as_shown(scan, setting))
    return judged(true, plan, rules, spent, limbs), judged(place, plan, rules, spent, limbs)


def _chain(tree: Tree) -> Refined:
    """What the chain makes of a tree, refined."""
    params = Parameters().changed("isolation", isolate="never")
    return skeletonize(tree.cloud, tree.truth.xyz[0], params).refined


def _true(tree: Tree, seed: int) -> Refined:
    """The true topology with few nodes, each astray, refined."""
    rough = thinned(shown(tree.truth, tree.counts), np.random.default_rng(seed))
    return refined(rough.moved(tree.cloud.to_input.inverse()), tree.cloud)


def judged(tree: Tree, plan: Plan, rules: CutRules, seconds: float, found_limbs: Limbs) -> Outcome:
    """A plan in the house frame of a tree's cloud against what the rules ask for on the truth."""
    to_house = tree.cloud.to_input.inverse()
    whole = tree.truth.moved(to_house)
    asked = plan_cuts(whole, None, rules).cuts
    limbs = Limbs.of(whole)
    by_name = {limb.name: limb for limb in limbs.all}
    lines = [by_name[cut.branch] for cut in asked]
    down = [limbs.beyond(limb, cut.along) for limb, cut in zip(lines, asked, strict=True)]
    gone = set(np.flatnonzero(np.any(down, axis=0)).tolist()) if down else set[int]()
    found = tuple(_judge(cut, asked, lines, whole, gone) for cut in plan.cuts)
    seen = shown(tree.truth, tree.counts).moved(to_house)
    demanded = plan_cuts(seen, None, rules).cuts
    met = tuple(_who_met(cut, found) for cut in demanded)
    by_name = {limb.name: limb for limb in Limbs.of(seen).all}
    ends = [(by_name[cut.branch], cut.along) for cut in demanded]
    middle = [limb.at((along + limb.along[-1]) / 2) for limb, along in ends]
    middles = np.array(middle).reshape(-1, 3)
    ideal = tuple(_judge(cut, asked, lines, whole, gone) for cut in demanded)
    best = sum(_who_met(cut, ideal) is not None for cut in demanded)
    return Outcome(demanded, met, found, plan, seconds, middles, found_limbs, best)


def _judge(
    cut: Cut, asked: tuple[Cut, ...], lines: list[Limb], whole: Skeleton, gone: set[int]
) -> Judged:
    """What a planned cut is: on a branch of which the rules ask for one, or on what else."""
    point = np.array(cut.point)
    best: tuple[float, float] | None = None
    for true, limb in zip(asked, lines, strict=True):
        beside, along = _on(limb, point)
        if true.rule == cut.rule and beside <= BESIDE and (best is None or beside < best[0]):
            best = beside, along - true.along
    if best is not None:
        return Judged(cut, "right", best[1])
    word, row = _wood_at(point, whole)
    return Judged(cut, "needless" if row in gone else word, np.nan)


def _on(limb: Limb, point: Floats) -> tuple[float, float]:
    """How far a point is from a limb's axis, and how far along; before the foot it is negative."""
    first = limb.heading(limb.bark)
    off = point - limb.xyz[0]
    before = float(off @ first)
    if before < 0:
        return float(np.linalg.norm(off - before * first)), before
    away = away_from(point[None], limb.xyz)[0]
    steps = np.arange(0, limb.along[-1] + 1e-9, 0.001)
    dense = np.column_stack([np.interp(steps, limb.along, limb.xyz[:, axis]) for axis in range(3)])
    return float(away), float(steps[np.linalg.norm(dense - point, axis=1).argmin()])


def _wood_at(point: Floats, whole: Skeleton) -> tuple[str, int]:
    """The label and row of the wood at a point: that whose bark is nearest, within reach."""
    away = np.linalg.norm(whole.xyz - point, axis=1) - whole.radius
    row = int(away.argmin())
    if away[row] > BLADE:
        return "nothing", -1
    return Label(whole.label[row]).word, row


def _who_met(true: Cut, found: tuple[Judged, ...]) -> Judged | None:
    """The planned cut nearest to a demanded one on its branch, if any."""
    near = [
        (float(np.linalg.norm(np.subtract(one.cut.point, true.point))), number)
        for number, one in enumerate(found)
        if one.word == "right" and one.cut.rule == true.rule
    ]
    if not near or min(near)[0] > NEAR:
        return None
    return found[min(near)[1]]


NEAR = 0.06
"""A planned cut stands for a demanded one so near, metres; whether it is in place is told apart."""


def lines_of(outcomes: list[Outcome], places: list[Outcome]) -> Iterator[str]:
    """What is printed of them."""
    met = [(cut, one) for o in outcomes for cut, one in zip(o.demanded, o.met, strict=True)]
    in_place = [one for o in outcomes for one in o.in_place]
    there = [one for o in places for one in o.in_place]
    planned = [one for o in outcomes for one in o.planned]
    sure = [one for one in planned if not one.cut.needs_review]
    plain = [yes and not (one and _is_other_choice(one.cut))
             for yes, (_, one) in zip(in_place, met, strict=True)]  # fmt: skip
    yield (f"{len(outcomes)} trees; the rules ask for {len(met)} cuts that the scans show; "
           f"{sum(one is not None for _, one in met)} were planned, {sum(in_place)} "
           f"({np.mean(in_place):.1%}) within 15 mm; in the scan's place {np.mean(there):.1%}; "
           f"without those for the other of two leaders alike {np.mean(plain):.1%}")  # fmt: skip
    for name, some in (("all", planned), ("without needs_review", sure)):
        words = Counter(one.word for one in some)
        off = np.array([abs(one.off) for one in some if one.word == "right"])
        wrong = len(some) - words["right"] - words["needless"]
        share = wrong / len(some) if some else np.nan
        place = "-" if not len(off) else (
            f"{(off <= IN_PLACE).mean():.1%} of the right within 15 mm, "
            f"median {1e3 * np.median(off):.0f} mm")  # fmt: skip
        yield (f"  {name}: {len(some)} cuts, {wrong} wrong ({share:.1%}): "
               f"{dict(words)}; {place}")  # fmt: skip
    most = sum(o.best for o in outcomes) / max(len(met), 1)
    yield f"  a plan of the true tree, as far as shown, would meet {most:.1%} of them"
    rules = Counter(cut.rule for cut, _ in met), Counter(one.cut.rule for one in planned)
    yield f"  by rule: asked {dict(rules[0])}, planned {dict(rules[1])}"
    reasons = Counter(_kind(reason) for one in planned for reason in one.cut.reasons)
    yield "  reviewed for: " + ", ".join(f"{kind} {n}" for kind, n in reasons.most_common())
    cpu = [o.seconds for o in outcomes]
    yield f"  CPU of planning: median {np.median(cpu):.3f} s, most {max(cpu):.3f} s"


def why_of(outcomes: list[Outcome]) -> Iterator[str]:
    """What came of the demanded cuts that are not in place, the commonest first."""
    words = Counter(
        f"{cut.rule}: {_fate(o, cut, one, middle)}"
        for o in outcomes
        for cut, one, middle, good in zip(o.demanded, o.met, o.middle, o.in_place, strict=True)
        if not good
    )
    total = sum(len(o.demanded) for o in outcomes)
    for word, count in words.most_common():
        yield f"    {count} ({count / total:.1%}) {word}"


def _fate(o: Outcome, cut: Cut, met: Judged | None, middle: Floats) -> str:
    """What came of one demanded cut that is not in place."""
    if met is not None:
        return "planned, over 15 mm off along the branch"
    away = [float(away_from(middle[None], limb.xyz)[0]) for limb in o.limbs.all]
    nearest = o.limbs.all[int(np.argmin(away))]
    if min(away) > BESIDE:
        return "no branch there"
    label = "side_branch" if cut.rule == "side_branches" else "leader"
    if nearest.label.word != label:
        return f"its wood is a {nearest.label.word}"
    for one in o.planned:
        if one.cut.branch == nearest.name and one.cut.rule == cut.rule:
            return f"planned elsewhere: on {one.word}"
    whys = [one.why for one in o.plan.left if (one.rule, one.branch) == (cut.rule, nearest.name)]
    return f"not planned: {_kind(whys[0])}" if whys else "not planned"


def _is_other_choice(cut: Cut) -> bool:
    return any(reason.startswith("only if ") for reason in cut.reasons)


def _kind(reason: str) -> str:
    """A reason without its numbers and names."""
    words = [word for word in reason.split() if not any(c.isdigit() for c in word)]
    return " ".join(words[:5])


def main() -> None:
    """Measure, and print."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--trees", type=int, default=20)
    parser.add_argument("--seed", type=int, default=970_000)
    parser.add_argument("--rules")
    parser.add_argument("--why", action="store_true")
    chosen = parser.parse_args()
    rules = CutRules.from_toml(chosen.rules) if chosen.rules else shipped_rules()
    settings: tuple[Setting, ...] = ("clean", "hard")
    seeds = range(chosen.seed, chosen.seed + chosen.trees)
    for setting in settings:
        topologies = ("true topology", "chain")
        found = [[outcomes(s, setting, rules, topology) for topology in topologies] for s in seeds]
        for number, topology in enumerate(topologies):
            true, places = (
                list(some) for some in zip(*(one[number] for one in found), strict=True)
            )
            print(f"== {setting}, {topology}")
            for line in (*lines_of(true, places), *(why_of(true) if chosen.why else ())):
                print(line, flush=True)


if __name__ == "__main__":
    main()
