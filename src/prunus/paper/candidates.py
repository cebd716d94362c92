"""Candidate edges: all pairs of superpoints within 2 r_super (sec. Edge evaluation)."""

from __future__ import annotations

import numpy as np

from prunus.geometry.near import within
from prunus.model import CandidateGraph, Superpoints


def find_candidates(superpoints: Superpoints) -> CandidateGraph:
    """The undirected pairs i < j at most 2 r_super apart. Two superpoints in one place get none."""
    xyz = superpoints.xyz
    start, second = within(xyz, xyz, 2 * superpoints.radius)
    first = np.repeat(np.arange(len(xyz)), np.diff(start))
    wanted = (first < second) & (xyz[first] != xyz[second]).any(axis=1)
    return CandidateGraph(superpoints, np.column_stack([first[wanted], second[wanted]]))
