"""Whose wood is whose, where several trees are in view: a network is asked for each of their feet.

It sees the threads in pieces of 6 cm, all that lies around a foot at once (a transformer), and says
how likely each is wood of the tree that stands there. The tree is the likeliest part of the ways
from the foot. Where the network is in doubt, cost tells.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.sparse.csgraph import dijkstra

from prunus.growth.graph import ThreadGraph
from prunus.growth.tokens import Tokens
from prunus.growth.ways import NOWHERE, cheapest
from prunus.model import Bools, Floats, Ints
from prunus.weights import WEIGHTS, open_network

SHIPPED = WEIGHTS / "owner.onnx"
SHOWN, TOLD = frozenset({"features", "xyz"}), frozenset({"logits"})
MOST_TOKENS = 800
"""So many around each foot are looked at; what lies farther off goes by cost."""
SUREST = 3.0
"""Log odds of one node count so much at most: a network is oftener wrong than it says."""
DOUBT = 1.0
"""Wood that no tree is likely to have is of none where the log odds of the one that it costs least
are below minus this; else it goes by cost."""


def likeliest(graph: ThreadGraph, feet: Ints, path: Path = SHIPPED) -> Ints:
    """The foot (N,) of the tree that each node most likely belongs to, `NOWHERE` = of none.

    Of a single foot everything is, and no network is asked. PrunusError where the file holds none.
    """
    if len(feet) == 1:
        return cheapest(graph, feet)
    cost, before = dijkstra(graph.belonging, indices=feet, return_predecessors=True)
    by_cost = np.where(np.isfinite(cost).any(axis=0), feet[cost.argmin(axis=0)], NOWHERE)
    tokens = Tokens.of(graph.threads, feet, cost)
    odds = log_odds(asked(tokens, path))[:, tokens.of_node]
    own = np.array([likely_part(*one) for one in zip(cost, before, odds, strict=True)])
    best = np.where(own, odds, -np.inf)
    # So are places far off: of these the log odds are NaN, and not less than any.
    doubtful = ((feet[:, None] == by_cost) & ~(odds < -DOUBT)).any(axis=0)
    tree = np.where(doubtful, by_cost, NOWHERE)
    tree = np.where(own.any(axis=0), feet[best.argmax(axis=0)], tree)
    tree[feet] = feet
    return tree


def asked(tokens: Tokens, path: Path) -> Floats:
    """What the network says of each token for each foot (F, T), NaN where it was not asked."""
    session = open_network(path, (SHOWN,), TOLD)
    found = np.full(tokens.cost.shape, np.nan)
    for foot, logits in enumerate(found):
        rows = tokens.near(foot, MOST_TOKENS)
        (logits[rows],) = session.run(["logits"], tokens.shown(foot, rows))
    return found


def log_odds(logits: Floats) -> Floats:
    """The log odds (F, T) that wood is of each tree and of no other, nor of one without a foot.

    That of none has a logit of 0 (a softmax over all trees and none).
    """
    known = np.where(np.isnan(logits), -np.inf, logits)
    known = np.vstack([known, np.zeros(known.shape[1])])
    others = [np.logaddexp.reduce(np.delete(known, foot, axis=0)) for foot in range(len(logits))]
    return np.asarray(logits - np.array(others))


def likely_part(cost: Floats, before: Ints, odds: Floats) -> Bools:
    """Which nodes (N,) are in the likeliest part of the ways from a foot that holds the foot.

    Exactly, by dynamic programming from the tips: what grows from a node is kept where its log odds
    sum up to more than nothing. So wood is not lost above a place of which the network is unsure.
    """
    order = np.argsort(cost, kind="stable")[: np.isfinite(cost).sum()].tolist()
    parent = before.tolist()
    worth = np.clip(np.nan_to_num(odds), -SUREST, SUREST).tolist()
    for node in reversed(order[1:]):
        if worth[node] > 0:
            worth[parent[node]] += worth[node]
    kept = np.zeros(len(cost), np.bool_)
    kept[order[0]] = True
    for node in order[1:]:
        kept[node] = worth[node] > 0 and kept[parent[node]]
    return kept
