"""What the edge networks are shown of the candidate graph (sec. Edge evaluation, Appendix A).

The paper's network sees an edge alone: its image and a description. Ours sees each edge among the
edges that it meets. Nothing here changes when the cloud is moved or turned half round about Z, or
when an edge's ends are swapped.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from prunus.kernels import profiles
from prunus.model import CandidateGraph, Floats, Ints, Superpoints

Inputs = NDArray[np.float32]

LOW = 5
"""The ground, or the foot of the tree, is this percentile of the superpoints' heights."""
MET = 8
"""An edge is told of so many edges at either end."""
EDGE_FEATURES = 15
MEETING_FEATURES = 5


@dataclass(frozen=True, eq=False)
class Context:
    """Every edge with the edges that it meets: E edges, W = MET of them at either end.

    profile (E, ALONG, AROUND): `kernels.profiles`, as logarithms; bend (E, STEPS, STEPS): how the
    drifts of any two steps agree (their dot product); edge (E, EDGE_FEATURES); met
    (E, 2 W): numbers of the edges met, -1 = none, those first that go on straightest; meeting
    (E, 2 W, MEETING_FEATURES).
    """

    profile: Inputs
    bend: Inputs
    edge: Inputs
    met: Ints
    meeting: Inputs


def description(candidates: CandidateGraph) -> Inputs:
    """Description vectors (E, 4): the midpoint relative to the tree, metres; sine of elevation.

    The midpoint is relative to the median along the row and in depth, without signs, and to the
    lower end in height.
    """
    place = _places(candidates.superpoints)
    ends = place[candidates.edges]
    vectors = np.diff(candidates.xyz[candidates.edges], axis=1)[:, 0]
    elevation = np.abs(vectors[:, 2]) / _lengths(vectors)
    return np.column_stack([np.abs(ends.mean(axis=1)), elevation]).astype(np.float32)


def context_of(candidates: CandidateGraph) -> Context:
    """The context of every candidate edge."""
    under, edges = candidates.superpoints, candidates.edges
    ends = (under.cloud.xyz, under.xyz, under.start, under.members, edges, under.radius)
    profile = np.log1p(profiles.edge_profiles(*ends))
    drifts = profiles.edge_drifts(*ends)
    bend = drifts @ drifts.transpose(0, 2, 1)
    met = edges_met(edges, len(under))
    met, meeting = _straightest(met, _meeting_features(candidates, met))
    return Context(profile, bend, _edge_features(candidates), met, meeting)


def edges_met(edges: Ints, nodes: int) -> Ints:
    """The edges (E, 2 W) that each edge meets at its first end, then at its second; -1 = none."""
    node = edges.ravel()
    order = np.argsort(node, kind="stable")
    degree = np.bincount(node, minlength=nodes)
    slot = np.arange(len(node)) - np.repeat(np.cumsum(degree) - degree, degree)
    at = np.full((nodes, int(degree.max(initial=1))), -1)
    at[node[order], slot] = order // 2
    met = at[edges].reshape(len(edges), -1)
    met[met == np.arange(len(edges))[:, None]] = -1
    return met


def _edge_features(candidates: CandidateGraph) -> Inputs:
    """Length, rise, direction along the row, place; then what the points at its ends are like.

    Of these: how many, how far they reach, the share of that along the edge, how much they are
    like a line, how much like a ball.
    """
    under, edges = candidates.superpoints, candidates.edges
    vectors = np.diff(under.xyz[edges], axis=1)[:, 0]
    lengths = _lengths(vectors)
    unit = vectors / lengths[:, None]
    spread = moments(under)
    reach = np.trace(spread, axis1=1, axis2=2)
    line = (spread**2).sum(axis=(1, 2)) / reach**2
    ball = np.linalg.det(spread) / reach**3
    along = np.einsum("ei,ekij,ej->ek", unit, spread[edges], unit) / reach[edges]
    columns = [lengths / under.radius, np.abs(unit[:, 2]), np.abs(unit[:, 0])]
    columns += [np.abs(_places(under)[edges].mean(axis=1))]
    for values in (np.log1p(np.diff(under.start))[edges], np.sqrt(reach)[edges] / under.radius):
        columns += [values.min(axis=1), values.max(axis=1)]
    columns += [along.min(axis=1), along.max(axis=1), line[edges].min(axis=1)]
    columns += [line[edges].max(axis=1), 27 * ball[edges].mean(axis=1)]
    return np.column_stack(columns).astype(np.float32)


def _meeting_features(candidates: CandidateGraph, met: Ints) -> Inputs:
    """For each edge met: cosine of the turn, its rise, length, gap of the far ends, whether any."""
    xyz, edges, r = candidates.xyz, candidates.edges, candidates.superpoints.radius
    shared = np.repeat(edges, met.shape[1] // 2, axis=1)
    far = edges.sum(axis=1)[:, None] - shared
    other = np.where(met >= 0, edges[met].sum(axis=2) - shared, shared)
    inward, outward = xyz[shared] - xyz[far], xyz[other] - xyz[shared]
    long, short = _lengths(inward), _lengths(outward)
    turn = (inward * outward).sum(axis=2) / (long * short)
    gap = np.linalg.norm(xyz[other] - xyz[far], axis=2)
    there = (met >= 0).astype(np.float64)
    columns = np.stack([turn, outward[..., 2] / short, short / r, gap / r, np.ones(met.shape)], 2)
    return (columns * there[..., None]).astype(np.float32)


def _straightest(met: Ints, meeting: Inputs) -> tuple[Ints, Inputs]:
    """The MET edges at either end that turn least, and what is known of them."""
    room = max(MET, met.shape[1] // 2)
    slots = [(0, 0), (0, 0), (0, room - met.shape[1] // 2)]
    at = np.pad(met.reshape(len(met), 2, -1), slots, constant_values=-1)
    known = np.pad(meeting.reshape(len(met), 2, -1, MEETING_FEATURES), [*slots, (0, 0)])
    turn = np.where(at >= 0, known[..., 0], -2.0)
    best = np.argsort(-turn, axis=2, kind="stable")[:, :, :MET]
    met = np.take_along_axis(at, best, axis=2).reshape(len(met), -1)
    known = np.take_along_axis(known, best[..., None], axis=2)
    return met, known.reshape(len(met), -1, MEETING_FEATURES)


def moments(under: Superpoints) -> Floats:
    """Second moments (N, 3, 3) of the points of each superpoint about it."""
    counts = np.diff(under.start)
    owner = np.repeat(np.arange(len(under)), counts)
    local = under.cloud.xyz[under.members] - under.xyz[owner]
    found = np.zeros((len(under), 3, 3))
    for i in range(3):
        for j in range(i, 3):
            sums = np.bincount(owner, local[:, i] * local[:, j], len(under))
            found[:, i, j] = found[:, j, i] = sums / np.maximum(counts, 1)
    return found + 1e-6 * np.eye(3)


def _places(under: Superpoints) -> Floats:
    """Superpoints (N, 3) relative to the middle of the tree, and to its lower end in height."""
    middle = np.median(under.xyz, axis=0)
    middle[2] = np.percentile(under.xyz[:, 2], LOW)
    return np.asarray(under.xyz - middle)


def _lengths(vectors: Floats) -> Floats:
    return np.asarray(np.maximum(np.linalg.norm(vectors, axis=-1), 1e-9))
