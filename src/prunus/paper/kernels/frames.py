"""The frame of each candidate edge and its edge image (sec. Edge evaluation)."""

import math

import numpy as np
from numpy.typing import NDArray

from prunus.geometry.compiled import kernel
from prunus.model.arrays import Floats, Ints

WIDE = 32
"""Bins along the edge."""
HIGH = 16
"""Bins across the edge."""


@kernel
def least_direction(matrix: Floats) -> Floats:
    """The least significant direction (3,) of a symmetric matrix (3, 3), by Jacobi rotations.

    Turning the points half round about Z turns the result, bit for bit: every step is odd or even
    in the entries that change their sign.
    """
    a = matrix.copy()
    v = np.eye(3)
    for _ in range(12):
        for p in range(2):
            for q in range(p + 1, 3):
                if a[p, q] == 0.0:
                    continue
                half = (a[q, q] - a[p, p]) / (2.0 * a[p, q])
                t = 1.0 / (abs(half) + math.sqrt(half * half + 1.0))
                if half < 0.0 or (half == 0.0 and a[p, q] < 0.0):
                    t = -t
                c = 1.0 / math.sqrt(t * t + 1.0)
                s = t * c
                for k in range(3):
                    kp, kq = a[k, p], a[k, q]
                    a[k, p], a[k, q] = c * kp - s * kq, s * kp + c * kq
                for k in range(3):
                    pk, qk = a[p, k], a[q, k]
                    a[p, k], a[q, k] = c * pk - s * qk, s * pk + c * qk
                for k in range(3):
                    kp, kq = v[k, p], v[k, q]
                    v[k, p], v[k, q] = c * kp - s * kq, s * kp + c * kq
    least = 0
    for k in range(1, 3):
        if a[k, k] < a[least, least]:
            least = k
    return v[:, least].copy()


@kernel
def either_end(
    points: Floats,
    nodes: Floats,
    start: Ints,
    members: Ints,
    edges: Ints,
    e: int,
    seen: Ints,
    local: Floats,
) -> int:
    """Write the points of either end of edge e, less its midpoint, into `local` (3, Q); how many.

    A point of both ends comes once: `seen` (P,) holds for each point the last edge that it was
    written for, so fill it with -1 and meet each edge once.
    """
    a, b = edges[e, 0], edges[e, 1]
    x = (nodes[a, 0] + nodes[b, 0]) / 2.0
    y = (nodes[a, 1] + nodes[b, 1]) / 2.0
    z = (nodes[a, 2] + nodes[b, 2]) / 2.0
    count = 0
    for end in (a, b):
        for slot in range(start[end], start[end + 1]):
            p = members[slot]
            local[0, count] = points[p, 0] - x
            local[1, count] = points[p, 1] - y
            local[2, count] = points[p, 2] - z
            # No branch, which half the points of the second end would mispredict: the next point
            # overwrites one that has been seen.
            count += seen[p] != e
            seen[p] = e
    return count


@kernel
def room_for_ends(start: Ints) -> int:
    """A length that holds the points of both ends of any edge."""
    largest = 0
    for n in range(len(start) - 1):
        largest = max(largest, start[n + 1] - start[n])
    return 2 * largest


@kernel
def spread(local: Floats, count: int) -> Floats:
    """Second moments (3, 3) about their mean of the first `count` points of `local` (3, Q).

    In one pass: coordinates are small and on a grid, so that the sums are all but exact.
    """
    x, y, z, xx, xy, xz, yy, yz, zz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for q in range(count):
        px, py, pz = local[0, q], local[1, q], local[2, q]
        x += px
        y += py
        z += pz
        xx += px * px
        xy += px * py
        xz += px * pz
        yy += py * py
        yz += py * pz
        zz += pz * pz
    n = max(count, 1)
    moments = np.empty((3, 3))
    moments[0, 0] = xx - x * x / n
    moments[1, 1] = yy - y * y / n
    moments[2, 2] = zz - z * z / n
    moments[0, 1] = moments[1, 0] = xy - x * y / n
    moments[0, 2] = moments[2, 0] = xz - x * z / n
    moments[1, 2] = moments[2, 1] = yz - y * z / n
    return moments


@kernel
def across(moments: Floats, x: Floats) -> Floats:
    """The y axis (3,) of the frame of an edge along the unit vector x; its sign is open.

    z is the least significant direction of points with these second moments (3, 3), made
    orthogonal to x; y = z cross x.
    """
    z = least_direction(moments)
    z = z - (z[0] * x[0] + z[1] * x[1] + z[2] * x[2]) * x
    size = math.sqrt(z[0] * z[0] + z[1] * z[1] + z[2] * z[2])
    if size < 1e-9:  # the least direction is along the edge: any frame about it will do
        z = np.array([-x[2] * x[0], -x[2] * x[1], x[0] * x[0] + x[1] * x[1]])
        size = math.sqrt(z[0] * z[0] + z[1] * z[1] + z[2] * z[2])
        if size < 1e-9:
            z, size = np.array([0.0, 1.0, 0.0]), 1.0
    z = z / size
    return np.array(
        [z[1] * x[2] - z[2] * x[1], z[2] * x[0] - z[0] * x[2], z[0] * x[1] - z[1] * x[0]]
    )


@kernel
def project(local: Floats, count: int, axis: Floats, onto: Floats) -> None:
    """Write the coordinates of the first `count` points of `local` (3, Q) along an axis (3,)."""
    x, y, z = axis[0], axis[1], axis[2]
    for q in range(count):
        onto[q] = local[0, q] * x + local[1, q] * y + local[2, q] * z


@kernel
def third_moment(values: Floats, count: int) -> float:
    """Sum of the cubes of the first `count` values."""
    total = 0.0
    for q in range(count):
        total += values[q] * values[q] * values[q]
    return total


@kernel
def tally(place: Ints, count: int, counts: NDArray[np.float32]) -> None:
    """Write into `counts` (B + 1,) how often each place stands among the first `count` (Q,).

    Place 0 is for points that fall into none of the B bins: cheaper than a branch for each.
    """
    counts[:] = 0.0
    for q in range(count):
        counts[place[q]] += 1.0


@kernel
def bins_of(
    along: Floats, aside: Floats, count: int, up: float, radius: float, place: Ints
) -> None:
    """Write 1 + the bin of each point, row by row; 0 outside. `up` = -1 turns the image over."""
    for q in range(count):
        column = (along[q] / (4.0 * radius) + 0.5) * WIDE
        row = (up * aside[q] / (2.0 * radius) + 0.5) * HIGH
        inside = (column >= 0.0) & (column < WIDE) & (row >= 0.0) & (row < HIGH)
        place[q] = 1 + int(row) * WIDE + int(column) if inside else 0


@kernel
def edge_images(
    points: Floats, nodes: Floats, start: Ints, members: Ints, edges: Ints, radius: float
) -> NDArray[np.float32]:
    """Edge images (E, HIGH, WIDE), each divided by its fullest bin; zeros where no point falls.

    The window is x in [-2 r, 2 r] along the edge (from its first node to its second) and y in
    [-r, r], with the sign that gives the points a third moment over zero; the points are those of
    either end.
    """
    E = len(edges)
    images = np.zeros((E, HIGH, WIDE), np.float32)
    seen = np.full(len(points), -1)
    room = room_for_ends(start)
    local, along, aside = np.empty((3, room)), np.empty(room), np.empty(room)
    place, counts = np.empty(room, np.int64), np.empty(1 + HIGH * WIDE, np.float32)
    for e in range(E):
        x = nodes[edges[e, 1]] - nodes[edges[e, 0]]
        x = x / math.sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2])
        count = either_end(points, nodes, start, members, edges, e, seen, local)
        project(local, count, x, along)
        project(local, count, across(spread(local, count), x), aside)
        up = -1.0 if third_moment(aside, count) < 0.0 else 1.0
        bins_of(along, aside, count, up, radius, place)
        tally(place, count, counts)
        peak = max(counts[1:].max(), 1.0)
        images[e] = (counts[1:] / peak).reshape(HIGH, WIDE)
    return images
