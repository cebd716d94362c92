"""Ways cut into branches: the longest first, each covering the wood around it.

What a branch covers needs no second strand. A branch that adds too little is none.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from prunus.field.votes import Threads
from prunus.growth.ways import NOWHERE, Ways
from prunus.model import Bools, Floats, Ints, Role, parents_first

COVER_M = 0.015
"""A branch covers what lies so far from its surface."""
THIN_M = 0.012
"""Radius that the thinnest branch is taken to have there."""
LEAST_M, LEAST_SPUR_M = 0.07, 0.12
"""Shorter branches are none; nor are these where most of one looks like a spur."""
SPUR = 0.4
"""Probability of a spur from which a branch looks like one."""
OUT_OF_WOOD_M = 0.045
"""A branch comes so far out of the wood that carries it."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Grown:
    """A tree over nodes of the threads: nodes (M,), the foot first; parent (M,) rows, -1 first."""

    nodes: Ints
    parent: Ints


def cut_branches(
    threads: Threads,
    ways: Ways,
    foot: int,
    branch_min: float = LEAST_M,
    spur_min: float = LEAST_SPUR_M,
) -> Grown:
    """The tree that grows from a foot; shorter branches (metres) are none."""
    cover = np.maximum(threads.radius, THIN_M) + COVER_M
    own = ways.foot == foot
    covered, before = ~own, np.full(len(threads), NOWHERE)
    inside = np.zeros(len(threads), np.bool_)
    inside[foot] = True
    order = np.flatnonzero(own)
    order = order[np.argsort(-ways.length[order], kind="stable")]
    for tip in order.tolist():
        if covered[tip] or inside[tip]:
            continue
        path = _way_back(ways.before, tip, inside)
        if not _is_branch(threads, path, covered, branch_min, spur_min):
            covered[path] = True
            continue
        path = _onto_host(threads.xyz, path, covered, inside)
        before[path[:-1]] = path[1:]
        inside[path] = True
        for near in threads.tree.query_ball_point(threads.xyz[path], cover[path]):
            covered[near] = True
    above = {int(node): int(before[node]) for node in np.flatnonzero(before != NOWHERE)}
    nodes, parent = parents_first(foot, above)
    return Grown(nodes=np.array(nodes), parent=np.array(parent))


def _way_back(before: Ints, tip: int, inside: Bools) -> Ints:
    """The nodes from a tip back to the first that is in the tree."""
    path = [tip]
    while not inside[path[-1]]:
        path.append(int(before[path[-1]]))
    return np.array(path)


def _is_branch(
    threads: Threads, path: Ints, covered: Bools, branch_min: float, spur_min: float
) -> bool:
    """Whether enough of a path is not covered yet."""
    step = np.linalg.norm(np.diff(threads.xyz[path], axis=0), axis=1)
    new = ~covered[path[:-1]]
    spur = np.average(threads.role[path[:-1], Role.SPUR_OR_SHOOT], weights=new + 1e-9)
    least = max(spur_min if spur > SPUR else branch_min,
                0.8 * threads.radius[path[-1]] + OUT_OF_WOOD_M)  # fmt: skip
    return bool(step[new].sum() >= least)


def _onto_host(xyz: Floats, path: Ints, covered: Bools, inside: Bools) -> Ints:
    """The path, straight onto the branch that carries it where it only runs along in its cover."""
    free = np.flatnonzero(~covered[path[:-1]])
    last = int(free[-1]) + 1  # the first node of the stretch that is covered to the end
    if last >= len(path) - 1:
        return path
    carriers = np.flatnonzero(inside)
    host = carriers[np.linalg.norm(xyz[carriers] - xyz[path[last]], axis=1).argmin()]
    return np.append(path[:last], host)
