"""Points within a radius, by a hash grid.

Points are sorted by counting into buckets of hashed cells with the side of the radius. A ball
then lies in 27 cells, whatever the extent of the cloud; a point counts only for its own cell, so
that two cells in one bucket do no harm. Membership is decided by distance alone.
"""

import numpy as np

from prunus.geometry.compiled import kernel
from prunus.model.arrays import GRID, Floats, Ints


@kernel
def bucket_of(x: int, y: int, z: int, buckets: int) -> int:
    """The bucket of a cell; `buckets` is a power of two."""
    mixed = (x * 73856093) ^ (y * 19349663) ^ (z * 83492791)
    return mixed & (buckets - 1)


@kernel
def build_grid(xyz: Floats, side: float) -> tuple[Ints, Ints, Ints]:
    """The cell (P, 3) of each point, the bucket starts (B + 1,), the points sorted by bucket."""
    P = len(xyz)
    buckets = 16
    while buckets < P:
        buckets *= 2
    cell = np.empty((P, 3), np.int64)
    start = np.zeros(buckets + 1, np.int64)
    for p in range(P):
        for axis in range(3):
            cell[p, axis] = int(np.floor(xyz[p, axis] / side))
        start[bucket_of(cell[p, 0], cell[p, 1], cell[p, 2], buckets) + 1] += 1
    for b in range(buckets):
        start[b + 1] += start[b]
    free = start[:-1].copy()
    order = np.empty(P, np.int64)
    for p in range(P):
        b = bucket_of(cell[p, 0], cell[p, 1], cell[p, 2], buckets)
        order[free[b]] = p
        free[b] += 1
    return cell, start, order


@kernel
def ball(
    xyz: Floats, grid: tuple[Ints, Ints, Ints], center: Floats, radius: float, found: Ints
) -> int:
    """Write the points within `radius` of `center` into `found`; how many. The grid's side is r."""
    cell, start, order = grid
    buckets = len(start) - 1
    cx = int(np.floor(center[0] / radius))
    cy = int(np.floor(center[1] / radius))
    cz = int(np.floor(center[2] / radius))
    count = 0
    for x in range(cx - 1, cx + 2):
        for y in range(cy - 1, cy + 2):
            for z in range(cz - 1, cz + 2):
                b = bucket_of(x, y, z, buckets)
                for slot in range(start[b], start[b + 1]):
                    p = order[slot]
                    if cell[p, 0] != x or cell[p, 1] != y or cell[p, 2] != z:
                        continue
                    dx = xyz[p, 0] - center[0]
                    dy = xyz[p, 1] - center[1]
                    dz = xyz[p, 2] - center[2]
                    if dx * dx + dy * dy + dz * dz <= radius * radius:
                        found[count] = p
                        count += 1
    return count


@kernel
def within(xyz: Floats, centers: Floats, radius: float) -> tuple[Ints, Ints]:
    """Points within `radius` of each center (N, 3), sorted: starts (N + 1,) and point indices."""
    grid = build_grid(xyz, radius)
    N = len(centers)
    found = np.empty(len(xyz), np.int64)
    start = np.zeros(N + 1, np.int64)
    members = np.empty(2 * len(xyz) + 16, np.int64)
    for n in range(N):
        count = ball(xyz, grid, centers[n], radius, found)
        end = start[n] + count
        if end > len(members):
            grown = np.empty(2 * end, np.int64)
            grown[: start[n]] = members[: start[n]]
            members = grown
        members[start[n] : end] = np.sort(found[:count])
        start[n + 1] = end
    return start, members[: start[N]].copy()


@kernel
def cover(xyz: Floats, order: Ints, radius: float) -> tuple[Floats, Ints]:
    """Cover the points by balls around uncovered ones, met in `order` (P,).

    Returns the mean point (N, 3) of each ball and how many points it holds (N,). Means are taken
    relative to the ball's first point: a moved cloud gives the same means, moved.
    """
    grid = build_grid(xyz, radius)
    P = len(xyz)
    covered = np.zeros(P, np.bool_)
    found = np.empty(P, np.int64)
    mean = np.empty((P, 3), np.float64)
    size = np.empty(P, np.int64)
    N = 0
    for p in order:
        if covered[p]:
            continue
        count = ball(xyz, grid, xyz[p], radius, found)
        total = np.zeros(3)
        for slot in range(count):
            covered[found[slot]] = True
            total += xyz[found[slot]] - xyz[p]
        mean[N] = xyz[p] + np.rint(total / count / GRID) * GRID
        size[N] = count
        N += 1
    return mean[:N].copy(), size[:N].copy()
