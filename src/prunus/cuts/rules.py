"""The pruning rules, each a named function: the cuts it asks for, and why it leaves the rest.

A rule sees the limbs of a tree and the rows that come down anyway by a rule before it. It says of
every branch it looks at either where to cut, or why not. None looks at trunk or support.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from prunus.cuts.limbs import Limb, Limbs
from prunus.cuts.settings import CutRules
from prunus.model import Bools, Label
from prunus.model.arrays import GRID

BOTH = 0.30
"""Leaders are compared where both have at least so many metres of height."""
PLAINLY = 1.15
"""Of two leaders one is plainly the thinner where the other's radius is so many times its own."""
SLOW = 0.05
"""Two confidences that differ by less are alike."""


@dataclass(frozen=True, kw_only=True)
class Demand:
    """A cut that a rule asks for: `along` a limb, metres from its start, and why.

    `stub` is the wood left between bark and blade, NaN where the branch is only shortened;
    `doubts` are what the rule itself is unsure of; `chosen` where it took one of two alike.
    """

    rule: str
    limb: Limb
    along: float
    stub: float
    because: str
    doubts: tuple[str, ...] = ()
    chosen: bool = False


@dataclass(frozen=True, kw_only=True)
class Left:
    """A branch that a rule looked at and left, and why."""

    rule: str
    branch: str
    why: str
    branch_number: int | None = None


Verdict = Demand | Left


@dataclass(frozen=True, eq=False)
class Down:
    """Rows (M,) that come down by the rules before; `unsure` those by doubtful choices alone."""

    rows: Bools
    unsure: Bools

    def and_by(self, limbs: Limbs, said: list[Verdict]) -> Down:
        """These, and what comes down by what a rule said."""
        rows, unsure = self.rows.copy(), self.unsure.copy()
        for one in said:
            if isinstance(one, Demand):
                gone = limbs.beyond(one.limb, one.along)
                unsure = np.where(gone & ~rows, one.chosen, unsure & ~(gone & (not one.chosen)))
                rows |= gone
        return Down(rows, unsure)


Rule = Callable[[Limbs, CutRules, Down], list[Verdict]]


def spacing(limbs: Limbs, rules: CutRules, down: Down) -> list[Verdict]:
    """Of two leaders too close to each other at mid height the weaker goes; the closest first."""
    closest = rules.spacing.closest
    leaders = [limb for limb in limbs.with_label(Label.LEADER) if not _is_gone(limb, down.rows)]
    pairs = sorted(
        (_apart(one, other), first, first + 1 + second)
        for first, one in enumerate(leaders)
        for second, other in enumerate(leaders[first + 1 :])
    )
    goes: dict[int, Demand] = {}
    for apart, first, second in pairs:
        if apart >= closest or first in goes or second in goes:
            continue
        weaker, how, doubts = _weaker(limbs, leaders[first], leaders[second])
        number = first if weaker is leaders[first] else second
        other = leaders[second if number == first else first]
        because = f"{apart:.2f} m from {other.name} at mid height, under {closest:g} m; {how}"
        cut = _at_foot("spacing", weaker, rules.spacing.stub, because, doubts)
        goes[number] = replace(cut, chosen=bool(doubts) and limbs.measured)
    return [goes.get(n) or _kept_by_spacing(n, leaders, pairs, goes, closest)
            for n in range(len(leaders))]  # fmt: skip


def height(limbs: Limbs, rules: CutRules, down: Down) -> list[Verdict]:
    """Leaders that reach too high over where they leave the support are shortened."""
    verdicts: list[Verdict] = []
    for limb in limbs.with_label(Label.LEADER):
        if _is_gone(limb, down.rows):
            verdicts.append(
                Left(
                    rule="height",
                    branch=limb.name,
                    why="comes down by another rule",
                    branch_number=limb.number,
                )
            )
            continue
        foot = _foot_on_support(limbs, limb)
        over = float(limb.xyz[:, 2].max()) - foot
        if over <= rules.height.over + GRID:
            why = f"{over:.2f} m over the support, not over {rules.height.over:g} m"
            verdicts.append(
                Left(rule="height", branch=limb.name, why=why, branch_number=limb.number)
            )
            continue
        because = f"{over:.2f} m over the support, over {rules.height.over:g} m"
        along = _rises_to(limb, foot + rules.height.to)
        verdicts.append(
            Demand(rule="height", limb=limb, along=along, stub=math.nan, because=because)
        )
    return verdicts


def side_branches(limbs: Limbs, rules: CutRules, down: Down) -> list[Verdict]:
    """Side branches of leaders that are longer than the limit go, down to a stub."""
    limit = rules.side_branches.longer_than
    least = limit - (rules.review.hidden if limbs.measured else 0.0)
    verdicts: list[Verdict] = []
    for limb in limbs.with_label(Label.SIDE_BRANCH):
        why = _not_a_case(limbs, limb, down)
        if why is None and limb.reach <= least + GRID:
            why = f"{limb.reach:.2f} m long, not over {limit:g} m"
        if why is None and limb.bark + rules.side_branches.stub >= limb.along[-1]:
            why = "does not stand clear of its leader"
        if why is not None:
            verdicts.append(
                Left(rule="side_branches", branch=limb.name, why=why, branch_number=limb.number)
            )
            continue
        because, doubts = _long(limb.reach, limit, rules.review.near_limit)
        if _is_gone(limb, down.rows):
            doubts += (f"only if {limbs.all[limb.parent].name} stays, which is not plain",)
        verdicts.append(_at_foot("side_branches", limb, rules.side_branches.stub, because, doubts))
    return verdicts


def _long(reach: float, limit: float, near: float) -> tuple[str, tuple[str, ...]]:
    """Why a side branch goes that is so long, and the doubts about that."""
    if reach <= limit + GRID:
        hidden = f"{limit - reach:.2f} m under the limit: its tip may be hidden"
        return f"{reach:.2f} m of it seen, limit {limit:g} m", (hidden,)
    doubts = (f"only {reach - limit:.2f} m over the limit",) if reach - limit < near else ()
    return f"{reach:.2f} m long, over {limit:g} m", doubts


RULES: tuple[Rule, ...] = (spacing, height, side_branches)
"""In the order in which they are asked: what a leader takes along needs no cut of its own."""


def verdicts(limbs: Limbs, rules: CutRules) -> list[Verdict]:
    """What every rule says of every branch that it looks at."""
    nothing = np.zeros(len(limbs.skeleton), np.bool_)
    down = Down(nothing, nothing)
    found: list[Verdict] = []
    for rule in RULES:
        name = rule.__name__
        if not getattr(rules, name).apply:
            found.append(Left(rule=name, branch="every branch", why="the rule is switched off"))
            continue
        said = rule(limbs, rules, down)
        down = down.and_by(limbs, said)
        found += said
    return found


def _at_foot(rule: str, limb: Limb, stub: float, because: str, doubts: tuple[str, ...]) -> Demand:
    return Demand(
        rule=rule, limb=limb, along=limb.bark + stub, stub=stub, because=because, doubts=doubts
    )


def _is_gone(limb: Limb, gone: Bools) -> bool:
    return bool(gone[limb.rows[-1]])


def _not_a_case(limbs: Limbs, limb: Limb, down: Down) -> str | None:
    """Why a side branch is none that the rule is for; None where it is one."""
    parent = limbs.parent_of(limb)
    if _is_gone(limb, down.rows & ~down.unsure):
        return "comes down by another rule"
    if parent is None:
        return "leaves nothing"
    if parent.label != Label.LEADER:
        return f"leaves {parent.name}, not a leader"
    return None


def _apart(one: Limb, other: Limb) -> float:
    """The level distance of two leaders at the middle of the height that both have; else inf."""
    low = max(float(limb.xyz[:, 2].min()) for limb in (one, other))
    high = min(float(limb.xyz[:, 2].max()) for limb in (one, other))
    if high - low < BOTH:
        return math.inf
    middle = (low + high) / 2
    places = [limb.at(_rises_to(limb, middle)) for limb in (one, other)]
    return math.hypot(*(places[0] - places[1])[:2])


def _rises_to(limb: Limb, z: float) -> float:
    """How far along a limb it first reaches a height."""
    high = limb.xyz[:, 2]
    if high[0] >= z:
        return 0.0
    row = int((high >= z).argmax())
    share = (z - high[row - 1]) / (high[row] - high[row - 1])
    return float(limb.along[row - 1] + share * (limb.along[row] - limb.along[row - 1]))


def _foot_on_support(limbs: Limbs, limb: Limb) -> float:
    """The height at which a leader, or the one that it forks from, leaves its support."""
    parent = limbs.parent_of(limb)
    while parent is not None and parent.label == Label.LEADER:
        limb, parent = parent, limbs.parent_of(parent)
    return float(limb.xyz[0, 2])


def _weaker(limbs: Limbs, one: Limb, other: Limb) -> tuple[Limb, str, tuple[str, ...]]:
    """The weaker of two leaders: the thinner, else the less sure, else the shorter."""
    radius, sure = (_medians(limbs, (one, other), column) for column in ("radius", "confidence"))
    if max(radius) >= PLAINLY * min(radius):
        thin = one if radius[0] < radius[1] else other
        return thin, f"{thin.name} is the thinner", ()
    if abs(sure[0] - sure[1]) >= SLOW:
        doubted = one if sure[0] < sure[1] else other
        how = f"{doubted.name} is the less sure of two alike"
        return doubted, how, (how,)
    short = one if one.along[-1] <= other.along[-1] else other
    how = f"{short.name} is the shorter of two alike"
    return short, how, (how,)


def _medians(limbs: Limbs, pair: tuple[Limb, Limb], column: str) -> list[float]:
    """The median of a column on each of two limbs; NaN, which compares as alike, where unknown."""
    values = getattr(limbs.skeleton, column)
    found = []
    for limb in pair:
        known = values[limb.rows[1:]]
        known = known[np.isfinite(known)]
        found.append(float(np.median(known)) if len(known) else math.nan)
    return found if np.isfinite(found).all() else [math.nan, math.nan]


def _kept_by_spacing(
    number: int,
    leaders: list[Limb],
    pairs: list[tuple[float, int, int]],
    goes: dict[int, Demand],
    closest: float,
) -> Left:
    """Why a leader stays: its nearest neighbour goes, or is far enough."""
    leader = leaders[number]
    own = [(apart, first + second - number) for apart, first, second in pairs
           if number in (first, second) and math.isfinite(apart)]  # fmt: skip
    if not own:
        return Left(
            rule="spacing",
            branch=leader.name,
            why="no other leader stands beside it",
            branch_number=leader.number,
        )
    apart, other = own[0]
    if apart >= closest:
        why = f"{apart:.2f} m from {leaders[other].name} at mid height, not under {closest:g} m"
    else:
        gone = next(leaders[n].name for near, n in own if near < closest and n in goes)
        why = f"{gone}, too close to it, goes"
    return Left(rule="spacing", branch=leader.name, why=why, branch_number=leader.number)
