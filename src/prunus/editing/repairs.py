"""What could be done in place of an act that breaks a rule; nothing is offered untried."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import replace

from prunus.editing.acts import (
    AddPath,
    MoveBase,
    Reattach,
    Relabel,
    RemoveBranch,
    RemoveEdge,
    Step,
    Together,
)
from prunus.editing.draft import Draft
from prunus.editing.legal import newly_broken
from prunus.editing.refused import Repairs
from prunus.editing.settle import Allowed, settled
from prunus.editing.steps import Stepped, stepped
from prunus.editing.words import a_branch, branch_names, listed
from prunus.errors import PrunusError
from prunus.model import Label, SeededGraph
from prunus.model.branch_names import NOUNS

MOST = 5
"""So many repairs are offered."""
MOST_STEPS = 4
"""A repair that takes more than so many further acts is none."""

Offer = tuple[str, Step | Together]


def tried(draft: Draft, act: Step | Together, graph: SeededGraph) -> Draft | None:
    """The draft after an act; None where it cannot be done."""
    done = _done(draft, act, graph)
    return None if done is None or newly_broken(draft, done) else done


def _done(draft: Draft, act: Step | Together, graph: SeededGraph) -> Draft | None:
    try:
        return stepped(draft, act, graph).draft
    except PrunusError:
        return None


def repairs(
    draft: Draft, act: Step | Together, wrong: Stepped | None, graph: SeededGraph
) -> Repairs:
    """Acts that can be done in place of one that left `wrong` (None: no tree at all)."""
    found: Repairs = []
    seen: list[Draft] = []
    names = branch_names(draft)
    offers = [*_other_ways(draft, act, names)]
    if wrong is not None:
        offers += _settling(draft, act, wrong, graph, names)
    for words, other in offers:
        done = tried(draft, other, graph)
        if done is not None and not any(_same(done, one) for one in seen):
            found.append((words, other))
            seen.append(done)
    return found[:MOST]


def _same(one: Draft, other: Draft) -> bool:
    return one.base == other.base and one.into == other.into


def _other_ways(draft: Draft, act: Step | Together, names: dict[int, str]) -> Iterator[Offer]:
    """The same act with another label, reach or direction."""
    if isinstance(act, AddPath):
        yield from _other_paths(draft, act, names)
    elif isinstance(act, Relabel) and act.node in names:
        own, word = names[act.node], a_branch(act.label)
        yield f"all of {own} becomes {word}", replace(act, reach="branch")
        yield f"{own} becomes {word} from here on", replace(act, reach="onward")
        yield f"{own} becomes {word} until here", replace(act, reach="until")
        yield f"this edge alone becomes {word}", replace(act, reach="edge")
    elif isinstance(act, RemoveEdge | RemoveBranch) and act.node in draft.into:
        first = draft.branch(act.node)[0] if isinstance(act, RemoveBranch) else act.node
        yield "the tree starts beyond this edge", MoveBase(first)


def _other_paths(draft: Draft, act: AddPath, names: dict[int, str]) -> Iterator[Offer]:
    start, end = act.stops[0], act.stops[-1]
    if not isinstance(start, int) or start not in draft:
        yield "is drawn from its other end", replace(act, stops=act.stops[::-1])
        return
    if isinstance(end, int) and end in draft and len(act.stops) == 2:
        yield f"{names[end]} is hung here instead", Reattach(end, start)
    if act.routed:
        yield "is drawn straight", replace(act, routed=False)
    own = None if start == draft.base else draft.into[start][1]
    for label in sorted(Label, key=lambda one: abs(one - act.label)):
        goes_on = own == label and not any(draft.into[n][1] == label for n in draft.after[start])
        becomes = f"becomes {a_branch(label)} of {names[start]}"
        words = f"goes on as {names[start]}" if goes_on else becomes
        yield words, replace(act, label=label, routed=act.routed)


def _settling(
    draft: Draft, act: Step | Together, wrong: Stepped, graph: SeededGraph, names: dict[int, str]
) -> Iterator[Offer]:
    """The act as it is, and as little as possible of the rest relabelled, or taken away.

    At first what hangs beyond its place is relabelled, then the rest of the tree.
    """
    now = wrong.draft
    placed = [node for node in now.nodes[1:] if draft.into.get(node) != now.into[node]]
    further = {one for node in placed for one in now.beyond(node)}
    before = set(now.nodes) - further
    for kept, relabel, remove in (
        (before, True, False),
        (set[int](), True, False),
        (before, True, True),
        (set[int](), False, True),
    ):
        right = settled(
            now, Allowed(kept=kept | wrong.touched, relabel=relabel, remove=remove, stays=placed)
        )
        if right is not None:
            steps = _between(now, right, graph)
            first = act.acts if isinstance(act, Together) else (act,)
            if len(steps) <= MOST_STEPS:
                yield _told(now, right, names), Together((*first, *steps))


def _between(wrong: Draft, right: Draft, graph: SeededGraph) -> list[Step]:
    """The acts that lead from one draft to another with fewer nodes and other labels."""
    gone = [n for n in wrong.nodes[1:] if n not in right and wrong.into[n][0] in right]
    removed: list[Step] = [RemoveEdge(node) for node in gone]
    changed = {n: right.into[n][1] for n in wrong.nodes[1:]
               if n in right and right.into[n][1] != wrong.into[n][1]}  # fmt: skip
    short = [*removed, *_runs(wrong, changed)]
    done = _done(wrong, Together(tuple(short)), graph)
    if done is not None and _same(done, right):
        return short
    return [*removed, *(Relabel(node, label) for node, label in changed.items())]


def _runs(wrong: Draft, changed: dict[int, Label]) -> list[Step]:
    """Other labels by whole branches, or onward from a node, where they change so."""
    found: list[Step] = []
    done: set[int] = set()
    for node, label in changed.items():
        if node in done:
            continue
        onward = wrong.onward(node)
        whole = all(changed.get(one) == label for one in onward)
        found.append(Relabel(node, label, "onward" if whole and len(onward) > 1 else "edge"))
        done |= set(onward) if whole else {node}
    return found


def _told(wrong: Draft, right: Draft, names: dict[int, str]) -> str:
    """`and leader 2 becomes a support`, `without 7 cm of side branch 4`."""
    parts = []
    gone = [n for n in wrong.nodes[1:] if n not in right]
    if gone:
        parts.append(f"without {listed(_parts(wrong, gone, names))}")
    for label in Label:
        changed = [n for n in wrong.nodes[1:]
                   if n in right and right.into[n][1] == label != wrong.into[n][1]]  # fmt: skip
        called = _parts(wrong, changed, names)
        if called:
            become = f"becomes {a_branch(label)}" if len(called) == 1 else (
                f"become {NOUNS[label]}" + ("es" if label == Label.SIDE_BRANCH else "s")
            )  # fmt: skip
            parts.append(f"{listed(called)} {become}")
    return f"as asked, {' and '.join(parts)}"


def _parts(draft: Draft, nodes: list[int], names: dict[int, str]) -> list[str]:
    """The branches to which edges belong; of those that are not meant in whole, how much is."""
    called = {node: names.get(node, NEW) for node in draft.nodes[1:]}
    whole = Counter(called.values())
    meant = Counter(called[node] for node in nodes)
    metres = {name: sum(draft.length(n) for n in nodes if called[n] == name) for name in meant}
    return [
        name if meant[name] == whole[name] else f"{100 * metres[name]:.0f} cm of {name}"
        for name in meant
    ]


NEW = "the new path"
"""What is not in the tree yet is called so."""
