"""The nearest legal tree, against trying out all of them."""

from itertools import product

import numpy as np
import pytest

from prunus.editing.draft import Draft
from prunus.editing.settle import EACH, REMOVED, Allowed, settled
from prunus.model import Label
from prunus.rules import offenders
from tests.editing.trees import state

GONE = None


def small(seed: int) -> Draft:
    """A base and five more nodes in any order, with any labels."""
    rng = np.random.default_rng(seed)
    into = {n: (int(rng.integers(n)), Label(int(rng.integers(4)))) for n in range(1, 6)}
    draft = state().draft
    return Draft(
        places=draft.places, superpoints=draft.superpoints, base=0, into=into, confidence={}
    )


def cost(draft: Draft, other: Draft) -> float:
    """What the changes from one draft to the other cost."""
    total = 0.0
    for node, (_, label) in draft.into.items():
        metres = draft.length(node) + EACH
        if node not in other:
            total += REMOVED * metres
        else:
            steps = abs(other.into[node][1] - label)
            total += metres * (1 + 0.1 * (steps - 1)) if steps else 0.0
    return total


def every(draft: Draft, allowed: Allowed) -> list[Draft]:
    """All legal trees that may come of it."""
    choices = []
    for node, (_, label) in draft.into.items():
        own = list(Label) if allowed.relabel and node not in allowed.kept else [label]
        choices.append([*own, GONE] if allowed.remove and node not in allowed.kept else own)
    found = []
    for labels in product(*choices):
        into = dict(zip(draft.into, labels, strict=True))
        hung = all(
            label is GONE or draft.into[n][0] == 0 or into[draft.into[n][0]] is not GONE
            for n, label in into.items()
        )
        if hung:
            tree = draft.changed(
                {n: None if x is GONE else (draft.into[n][0], x) for n, x in into.items()}
            )
            if offenders(tree.skeleton()) == {}:
                found.append(tree)
    return found


@pytest.mark.parametrize("relabel", [True, False])
@pytest.mark.parametrize("remove", [True, False])
@pytest.mark.parametrize("seed", range(8))
def test_no_legal_tree_is_nearer(seed: int, relabel: bool, remove: bool) -> None:
    draft = small(seed)
    allowed = Allowed(kept=[1 + seed % 5], relabel=relabel, remove=remove)
    found, others = settled(draft, allowed), every(draft, allowed)
    if found is None:
        assert others == []
        return
    assert offenders(found.skeleton()) == {}
    assert cost(draft, found) == pytest.approx(min(cost(draft, other) for other in others))


def test_a_legal_tree_is_its_own_nearest() -> None:
    draft = state().draft
    found = settled(draft, Allowed(kept=[], relabel=True, remove=True))
    assert found is not None
    assert found.into == draft.into


def test_what_stays_is_not_taken_away() -> None:
    draft = small(0)
    found = settled(draft, Allowed(kept=[], relabel=True, remove=True, stays=[5]))
    assert found is not None
    assert 5 in found
