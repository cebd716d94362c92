"""What an act breaks; that the machine's own tree breaks rules, as true trees do, is not told."""

from __future__ import annotations

from prunus.editing.draft import Draft
from prunus.rules import offenders


def newly_broken(before: Draft, after: Draft) -> dict[str, list[int]]:
    """The nodes at which a rule is broken that held there before, by the name of the rule."""
    known = _broken(before)
    new = {rule: sorted(nodes - known.get(rule, set())) for rule, nodes in _broken(after).items()}
    return {rule: nodes for rule, nodes in new.items() if nodes}


def _broken(draft: Draft) -> dict[str, set[int]]:
    found = offenders(draft.skeleton())
    return {rule: {draft.nodes[row] for row in rows.tolist()} for rule, rows in found.items()}
