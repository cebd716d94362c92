"""Turn angles and turn penalties between a directed edge and those that may follow it."""

import math

import numpy as np

from prunus.geometry.compiled import kernel
from prunus.model.arrays import Floats, Ints


@kernel
def turn_angle(first: Floats, second: Floats) -> float:
    """The angle between two directions, 0 = straight on (eq. anglechange)."""
    dot = first[0] * second[0] + first[1] * second[1] + first[2] * second[2]
    size = math.sqrt(
        (first[0] * first[0] + first[1] * first[1] + first[2] * first[2])
        * (second[0] * second[0] + second[1] * second[1] + second[2] * second[2])
    )
    return math.acos(min(1.0, max(-1.0, dot / size)))


@kernel
def turn_penalties(
    vector: Floats, head: Ints, out_start: Ints, pair_start: Ints, theta: float, c: float, p: float
) -> Floats:
    """TurnPenalty under the None labelling (eq. turnpenalty) of every pair of following edges.

    Entry `pair_start[d] + k` is for directed edge d followed by the k-th edge that leaves its
    head. Rounded to 2^-32, so that sums of them are exact in any order.
    """
    penalty = np.zeros(pair_start[-1])
    for d in range(len(head)):
        first = out_start[head[d]]
        for follower in range(first, out_start[head[d] + 1]):
            angle = turn_angle(vector[follower], vector[d])
            if angle > theta:
                value = c * (angle - theta) ** p
                penalty[pair_start[d] + follower - first] = np.rint(value * 2.0**32) / 2.0**32
    return penalty


def grow_angle(vectors: Floats) -> Floats:
    """GrowAngle (...,) of vectors (..., 3) in the XZ plane: 0 level, pi / 2 upright (eq. angle).

    A vector purely in depth counts as level.
    """
    return np.arctan2(np.abs(vectors[..., 2]), np.abs(vectors[..., 0]))
