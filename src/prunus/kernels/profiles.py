"""The profile of each candidate edge: where its points lie along it and how far from its line."""

import math

import numpy as np
from numpy.typing import NDArray

from prunus.kernels.compiled import kernel
from prunus.kernels.frames import either_end, room_for_ends, tally
from prunus.model.arrays import Floats, Ints

ALONG = 24
"""Bins along the edge."""
STEPS = ALONG // 2
"""Bins along the edge for drifts: two of a profile."""
REACH = 1.5
"""How far they reach from its midpoint, to either side, in r."""
RINGS = (0.1, 0.2, 0.3, 0.4, 0.5, 0.65, 0.8, 1.0)
"""Outer borders of the rings about the edge's line, in r."""
AROUND = len(RINGS)


@kernel
def bins_of(local: Floats, count: int, axis: Floats, radius: float, place: Ints) -> None:
    """Write 1 + the bin of each of the first `count` points of `local` (3, Q); 0 outside."""
    x, y, z = axis[0], axis[1], axis[2]
    borders = (np.array(RINGS) * radius) ** 2
    for q in range(count):
        px, py, pz = local[0, q], local[1, q], local[2, q]
        along = px * x + py * y + pz * z
        px -= along * x
        py -= along * y
        pz -= along * z
        off = px * px + py * py + pz * pz
        ring = 0
        for k in range(AROUND):
            ring += off >= borders[k]
        step = (along / (2.0 * REACH * radius) + 0.5) * ALONG
        inside = (step >= 0.0) & (step < ALONG) & (ring < AROUND)
        place[q] = 1 + int(step) * AROUND + ring if inside else 0


@kernel
def line_of(nodes: Floats, edges: Ints, e: int) -> Floats:
    """The direction (3,) of an edge from its lower-numbered end, whatever the edge says.

    A point on the border of two bins then falls on the same side both ways.
    """
    x = nodes[max(edges[e, 0], edges[e, 1])] - nodes[min(edges[e, 0], edges[e, 1])]
    return x / math.sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2])


@kernel
def edge_profiles(
    points: Floats, nodes: Floats, start: Ints, members: Ints, edges: Ints, radius: float
) -> NDArray[np.float32]:
    """How many points of either end lie where, (E, ALONG, AROUND), about the line of each edge.

    First axis: equal bins along the edge, from its first node to its second, over
    [-REACH r, REACH r] about its midpoint. Second axis: rings by distance from its line. Points
    beyond count nowhere. An edge with its ends swapped has the same profile reversed along the
    first axis, exactly.
    """
    E = len(edges)
    profiles = np.zeros((E, ALONG, AROUND), np.float32)
    seen = np.full(len(points), -1)
    room = room_for_ends(start)
    local, place = np.empty((3, room)), np.empty(room, np.int64)
    counts = np.empty(1 + ALONG * AROUND, np.float32)
    for e in range(E):
        x = line_of(nodes, edges, e)
        count = either_end(points, nodes, start, members, edges, e, seen, local)
        bins_of(local, count, x, radius, place)
        tally(place, count, counts)
        profile = counts[1:].reshape(ALONG, AROUND)
        profiles[e] = profile if edges[e, 0] < edges[e, 1] else profile[::-1]
    return profiles


@kernel
def edge_drifts(
    points: Floats, nodes: Floats, start: Ints, members: Ints, edges: Ints, radius: float
) -> NDArray[np.float32]:
    """Where the points of each step along an edge lie beside its line: mean offset (E, STEPS, 3).

    Of the points that `edge_profiles` counts, in units of the radius, square to the edge; zero in
    steps without points. An edge with its ends swapped has the same drifts reversed.
    """
    E = len(edges)
    drifts = np.zeros((E, STEPS, 3), np.float32)
    seen = np.full(len(points), -1)
    room = room_for_ends(start)
    local, place = np.empty((3, room)), np.empty(room, np.int64)
    sums, counts = np.empty((1 + STEPS, 3)), np.empty(1 + STEPS)
    for e in range(E):
        x = line_of(nodes, edges, e)
        count = either_end(points, nodes, start, members, edges, e, seen, local)
        bins_of(local, count, x, radius, place)
        sums[:], counts[:] = 0.0, 0.0
        for q in range(count):
            step = (place[q] + 2 * AROUND - 1) // (2 * AROUND)  # 0 outside, else 1 + the step
            along = local[0, q] * x[0] + local[1, q] * x[1] + local[2, q] * x[2]
            counts[step] += 1.0
            for axis in range(3):
                sums[step, axis] += local[axis, q] - along * x[axis]
        for step in range(STEPS):
            row = step if edges[e, 0] < edges[e, 1] else STEPS - 1 - step
            for axis in range(3):
                if counts[1 + step] > 0.0:
                    drifts[e, row, axis] = sums[1 + step, axis] / counts[1 + step] / radius
    return drifts
