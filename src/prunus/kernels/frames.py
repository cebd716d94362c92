"""The frame of each candidate edge and its edge image (sec. Edge evaluation)."""

import math

import numpy as np
from numpy.typing import NDArray

from prunus.kernels.compiled import kernel
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
def across(points: Floats, x: Floats) -> Floats:
    """The y axis (3,) of the frame of an edge along the unit vector x, for points (Q, 3).

    z is the least significant direction of the points, made orthogonal to x; y = z cross x, with
    the sign that gives the points a third moment over zero.
    """
    centre = np.zeros(3)
    for q in range(len(points)):
        centre += points[q]
    centre /= max(len(points), 1)
    spread = np.zeros((3, 3))
    for q in range(len(points)):
        for i in range(3):
            for j in range(3):
                spread[i, j] += (points[q, i] - centre[i]) * (points[q, j] - centre[j])
    z = least_direction(spread)
    z = z - (z[0] * x[0] + z[1] * x[1] + z[2] * x[2]) * x
    size = math.sqrt(z[0] * z[0] + z[1] * z[1] + z[2] * z[2])
    if size < 1e-9:  # the least direction is along the edge: any frame about it will do
        z = np.array([-x[2] * x[0], -x[2] * x[1], x[0] * x[0] + x[1] * x[1]])
        size = math.sqrt(z[0] * z[0] + z[1] * z[1] + z[2] * z[2])
        if size < 1e-9:
            z, size = np.array([0.0, 1.0, 0.0]), 1.0
    z = z / size
    y = np.array([z[1] * x[2] - z[2] * x[1], z[2] * x[0] - z[0] * x[2], z[0] * x[1] - z[1] * x[0]])
    skew = 0.0
    for q in range(len(points)):
        side = points[q, 0] * y[0] + points[q, 1] * y[1] + points[q, 2] * y[2]
        skew += side * side * side
    return -y if skew < 0.0 else y


@kernel
def united(first: Ints, second: Ints, both: Ints) -> int:
    """Write the union of two sorted lists into `both`; its length."""
    i, j, count = 0, 0, 0
    while i < len(first) or j < len(second):
        if j == len(second) or (i < len(first) and first[i] < second[j]):
            both[count] = first[i]
            i += 1
        elif i == len(first) or second[j] < first[i]:
            both[count] = second[j]
            j += 1
        else:
            both[count] = first[i]
            i += 1
            j += 1
        count += 1
    return count


@kernel
def edge_images(
    points: Floats, nodes: Floats, start: Ints, members: Ints, edges: Ints, radius: float
) -> NDArray[np.float32]:
    """Edge images (E, HIGH, WIDE), each divided by its fullest bin; zeros where no point falls.

    The window is x in [-2 r, 2 r] along the edge (from its first node to its second) and y in
    [-r, r]; the points are those of either end.
    """
    E = len(edges)
    images = np.zeros((E, HIGH, WIDE), np.float32)
    largest = 1
    for n in range(len(nodes)):
        largest = max(largest, start[n + 1] - start[n])
    both = np.empty(2 * largest, np.int64)
    local = np.empty((2 * largest, 3))
    for e in range(E):
        a, b = edges[e, 0], edges[e, 1]
        middle = (nodes[a] + nodes[b]) / 2.0
        x = nodes[b] - nodes[a]
        x = x / math.sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2])
        count = united(members[start[a] : start[a + 1]], members[start[b] : start[b + 1]], both)
        for q in range(count):
            local[q] = points[both[q]] - middle
        y = across(local[:count], x)
        image = images[e]
        for q in range(count):
            along = local[q, 0] * x[0] + local[q, 1] * x[1] + local[q, 2] * x[2]
            aside = local[q, 0] * y[0] + local[q, 1] * y[1] + local[q, 2] * y[2]
            column = math.floor((along / (4.0 * radius) + 0.5) * WIDE)
            row = math.floor((aside / (2.0 * radius) + 0.5) * HIGH)
            if 0 <= column < WIDE and 0 <= row < HIGH:
                image[row, column] += 1.0
        peak = image.max()
        if peak > 0.0:
            image /= peak
    return images
